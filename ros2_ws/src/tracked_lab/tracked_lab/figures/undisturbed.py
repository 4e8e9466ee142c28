"""Figures 5.17 to 5.20: one layer and two on the way over the step."""

import numpy as np

from tracked_lab.figures.command_activity import changes, compensation
from tracked_lab.figures.figure_runs import FigureRuns, RunDrawing, figures_of
from tracked_lab.figures.slip_rates import MOVING_S
from tracked_lab.gallery.entry import Check, Entry, Label, exactly, holds
from tracked_report.metrics.comparison import reduction_percent
from tracked_report.plots import signal_plots, tracking_plots

_TASK = "Simulated: the robot follows an S-curve over a 40 mm step on a floor where its tracks slip."
_TABLE = {"x_m": (62.35, 37.99), "y_m": (58.96, 51.72), "theta_rad": (51.88, 38.76)}
"""Reductions of RMS and peak to peak that Table 5.1 prints (per cent)."""
_NAMES = {"x_m": "x", "y_m": "y", "theta_rad": "heading"}


def states(runs: FigureRuns) -> Entry:
    """Figures 5.17 and 5.18."""
    single, double = figures_of(runs.single), figures_of(runs.double)
    checks: list[Check] = []
    for name, record, values in (("single", runs.single, single), ("double", runs.double, double)):
        checks += [
            holds(f"{name} layer, goal reached", len(record.channel("goal_reached")) == 1, "yes"),
            Check(f"{name} layer, from the goal at the end, estimated frame", values["estimated.final_distance_m"],
                  0.0, 0.05, unit="m"),
            Check(f"{name} layer, the same in the true frame", values["true.final_distance_m"], 0.0, 0.1, unit="m"),
            Check(f"{name} layer, at rest there after the reference by", values["estimated.settling_s"], 0.0,
                  10.0 if name == "single" else 1.0, unit="s"),
        ]  # fmt: skip
    return Entry(
        "Figs 5.17, 5.18",
        "States under one layer and under two",
        Label.CORRECTED,
        f"{_TASK} Both follow and come to the target. The single layer, whose commands are 0.1 s old when they act, "
        "overshoots at the start, and at the end manoeuvres once more to take its last error out. What lies between "
        "estimate and truth is the drift of odometry, which no controller sees.",
        tuple(checks),
        (
            RunDrawing(
                "States",
                "Dashed the reference, in colour what the controller believes, green the truth; the reference begins "
                "to move at 2 s.",
                runs.undisturbed,
                tracking_plots.states,
            ),
        ),
        ("5.2.4", "5.2.12", "5.2.20", "5.1 (table)"),
        headline=f"at rest on the goal {checks[3].value:.1f} s after the reference with one layer, "
        f"{checks[7].value:.1f} s with two",
    )


def errors(runs: FigureRuns) -> Entry:
    """Figure 5.19."""
    single, printed, double = (figures_of(record) for record in (runs.single, runs.printed, runs.double))
    checks: list[Check] = []
    for axis, (rms, ptop) in _TABLE.items():
        for kind, said, words in (("rms", rms, "RMS"), ("ptop", ptop, "peak to peak")):
            key = f"estimated.{kind}_{axis}"
            less = reduction_percent(single[key], double[key])
            checks.append(Check(f"{words} of {_NAMES[axis]}, lower by", less, said, 100.0, f"{said:g}", "%"))
        key = f"estimated.rms_{axis}"
        less = reduction_percent(single[key], printed[key])
        checks.append(Check(f"as printed, RMS of {_NAMES[axis]}, lower by", less, rms, 100.0, f"{rms:g}", "%"))
    heading, y = (reduction_percent(single[f"true.rms_{a}"], double[f"true.rms_{a}"]) for a in ("theta_rad", "y_m"))
    checks += [
        Check("true frame, RMS of heading, lower by", heading, 50.0, 100.0, unit="%"),
        Check("true frame, RMS of y, lower by (drift decides)", y, -25.0, 50.0, unit="%"),
    ]
    return Entry(
        "Fig 5.19",
        "Tracking errors of one layer and of two",
        Label.REPRODUCED,
        f"{_TASK} Two layers, as printed and improved, more than halve what the controller sees. In the true frame the "
        "heading gains as much, while x and y are mostly drift of odometry: y gains nothing on this seed. One run; "
        "medians over seeds are the matter of Table 5.1.",
        tuple(checks),
        (
            RunDrawing(
                "Errors",
                "Reference minus pose. Left what the controller sees, right what is true.",
                {**runs.undisturbed, "double layer as printed": runs.printed},
                tracking_plots.errors,
            ),
        ),
        ("5.2.12", "5.1 (table)"),
        headline=f"RMS of x, y, heading lower by {', '.join(f'{c.value:.0f}' for c in checks[::3][:3])} %",
    )


def commands(runs: FigureRuns) -> Entry:
    """Figure 5.20."""
    single, double = (changes(record, *MOVING_S) / (MOVING_S[1] - MOVING_S[0]) for record in (runs.single, runs.double))
    correlation, gain = compensation(runs.double, *MOVING_S)
    violations = sum(figures_of(record)["command.violations"] for record in runs.undisturbed.values())
    checks = (
        exactly("commands outside the limits", violations, 0.0, "0"),
        Check("new yaw rates asked, single layer", single, 4.0, 5.5, "5", "1/s"),
        Check("new yaw rates asked, double layer", double, 25.0, 30.5, "30", "1/s"),
        Check("lower minus upper yaw rate, correlation with the slip lost", correlation, 0.85, 1.0),
        Check("lower minus upper yaw rate, per slip lost", gain, 0.8, np.inf),
    )
    return Entry(
        "Fig 5.20",
        "Commands of one layer and of two",
        Label.CORRECTED,
        f"{_TASK} The lower layer adds to the plan of the upper one what the ground takes: the yaw rate that it asks "
        "beyond the plan is, up to its feedback, the slip yaw rate with the sign turned.",
        checks,
        (
            RunDrawing(
                "Commands",
                "Solid what the base was sent, dashed the first input of each plan, dotted the limits.",
                runs.undisturbed,
                signal_plots.commands,
            ),
        ),
        ("5.2.12", "5.2.5"),
        headline=f"what is added follows the slip, correlation {correlation:.2f}",
    )
