"""Figures 5.21 to 5.24: the robot is turned by force on its way."""

import numpy as np

from tracked_lab.figures.command_activity import changes, limit_stretch, yaw_rates
from tracked_lab.figures.figure_runs import FigureRuns, RunDrawing, figures_of
from tracked_lab.gallery.entry import Check, Entry, Label, exactly, holds
from tracked_report.plots import signal_plots, tracking_plots
from tracked_report.plots.crossings import forced

_TASK = (
    "Simulated: the same task, but from 1.6 to 2.2 s after the reference has begun to move (3.6 to 4.2 s on the "
    "pictures' axis) something takes hold of the robot and turns it."
)
_TICK_S = 0.2
"""One period of the upper layer."""
_ROUNDING_S = 1e-6


def disturbed_states(runs: FigureRuns) -> Entry:
    """Figures 5.21 and 5.22."""
    single, double = figures_of(runs.pushed_single), figures_of(runs.pushed_double)
    recovery = double.get("estimated.recovery_s", np.inf)
    slower = single.get("estimated.recovery_s", np.inf)
    checks = (
        Check("heading thrown off by", double["estimated.max_theta_rad"], 0.4, 1.5, unit="rad"),
        Check("back within 3 cm and 0.05 rad after", recovery, 0.0, 4.0, "quickly", "s"),
        Check("the same with the single layer", slower, recovery, np.inf, unit="s"),
        holds("goal reached all the same", len(runs.pushed_double.channel("goal_reached")) == 1, "yes"),
        Check("from the goal at the end, estimated frame", double["estimated.final_distance_m"], 0.0, 0.05, unit="m"),
        Check("the same in the true frame", double["true.final_distance_m"], 0.0, 0.4, unit="m"),
    )
    return Entry(
        "Figs 5.21, 5.22",
        "A sudden change of the pose: path and states",
        Label.CORRECTED,
        f"{_TASK} It leaves the path, and comes back to it once it is let go; the single layer, which the thesis does "
        "not show here, takes longer. How long either takes depends on the throw, whose size the thesis does not give. "
        "While the robot is held its belts slide, so that its own estimate of where it is, and with it the true end "
        "of the path, is shifted.",
        checks,
        (
            RunDrawing("Fig 5.21: from above", "World frame, true paths.", runs.pushed, tracking_plots.scene),
            RunDrawing("Fig 5.22 (a): states", "As Figs 5.17 and 5.18.", runs.pushed, tracking_plots.states),
            RunDrawing(
                "Fig 5.22 (b): the transient",
                "The thesis's window, 1.2 to 2.8 s after the reference has begun to move.",
                runs.pushed,
                tracking_plots.transient,
            ),
        ),
        ("5.2.12", "5.1 (table)"),
        headline=f"back after {recovery:.1f} s, the single layer after {slower:.1f} s",
    )


def disturbed_errors(runs: FigureRuns) -> Entry:
    """Figure 5.23."""
    single, double = figures_of(runs.pushed_single), figures_of(runs.pushed_double)
    quiet = figures_of(runs.double)
    shares = {
        name: double[f"estimated.rms_{axis}"] / single[f"estimated.rms_{axis}"]
        for name, axis in (("x", "x_m"), ("y", "y_m"), ("heading", "theta_rad"))
    }
    percent = ", ".join(f"{100.0 * share:.0f}" for share in shares.values())
    thrown = double["estimated.rms_y_m"] / quiet["estimated.rms_y_m"]
    checks = (
        *(Check(f"RMS of {name}, share of the single layer's", share, 0.0, 1.0) for name, share in shares.items()),
        Check("RMS of y, times that of the undisturbed run", thrown, 3.0, np.inf),
    )
    return Entry(
        "Fig 5.23",
        "A sudden change of the pose: tracking errors",
        Label.CORRECTED,
        f"{_TASK} The throw outweighs all other errors of the run. Two layers shorten the way back, but nothing can "
        "undo the throw itself, so that the gain is smaller than in Fig 5.19.",
        checks,
        (
            RunDrawing(
                "Errors",
                "Reference minus pose. Left what the controller sees, right what is true.",
                runs.pushed,
                tracking_plots.errors,
            ),
        ),
        ("5.1 (table)",),
        headline=f"RMS of x, y, heading {percent} % of one layer's",
    )


def disturbed_commands(runs: FigureRuns) -> Entry:
    """Figure 5.24."""
    taken_s, let_go_s, _ = forced(runs.pushed_double)[0]
    limits = runs.pushed_double.meta.limits
    limit = np.nan if limits is None else limits.yaw_rate_max_radps
    (single_s, _), (double_s, leaves_s) = (limit_stretch(run, taken_s, limit) for run in runs.pushed.values())
    _, sent = yaw_rates(runs.pushed_double, "cmd_vel", let_go_s, let_go_s + _TICK_S)
    at_limit = 100.0 * float(np.mean(np.abs(sent) >= limit - 1e-6))
    back = changes(runs.pushed_double, leaves_s, leaves_s + _TICK_S)
    soon_s = _TICK_S + _ROUNDING_S
    checks = (
        Check("yaw rate at its limit after the grip, double layer", double_s - taken_s, 0.0, soon_s, unit="s"),
        Check("the same, single layer", single_s - taken_s, _TICK_S, 1.0, unit="s"),
        Check("of the 0.2 s after being let go spent at that limit", at_limit, 100.0, 100.0, "adjusts", "%"),
        Check("new yaw rates in the 0.2 s after leaving it", back, 5, 6, "more than one"),
        exactly("commands outside the limits", figures_of(runs.pushed_double)["command.violations"], 0.0, "0"),
    )
    return Entry(
        "Fig 5.24",
        "A sudden change of the pose: commands of both layers",
        Label.DIFFERS,
        f"{_TASK} The thesis sees the lower layer adjust the heading within 0.2 s of being let go. Here it is quicker "
        "than the upper layer at both ends of the turn back, from the grip to the limit of the yaw rate and from the "
        "limit to the path, but just after being let go it can only stay at that limit.",
        checks,
        (
            RunDrawing(
                "Commands",
                "Solid what the base was sent, dashed the first input of each plan, dotted the limits.",
                runs.pushed,
                signal_plots.commands,
            ),
        ),
        ("5.2.5", "5.2.12"),
        headline=f"at the limit {double_s - taken_s:.2f} s after the grip, the single layer {single_s - taken_s:.2f} s",
    )
