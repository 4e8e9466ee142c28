"""Figure 5.10: slip measured more or less often."""

from typing import Any

import numpy as np

from tracked_lab.figures.figure_runs import FigureRuns
from tracked_lab.figures.slip_sampling import MeasuredSlip, held, measured_slip, true_slip
from tracked_lab.gallery.entry import Check, Drawing, Entry, Label
from tracked_report.channel import Array
from tracked_report.plots.crossings import shade_crossings
from tracked_report.plots.style import INK, LIMIT, legend_above, variant_colour
from tracked_report.run_record import RunRecord
from tracked_report.signals import root_mean_square

FULL_HZ, LOWER_HZ, UPPER_HZ = 60, 30, 5
MOVING_S = (2.0, 15.0)
"""From the first motion of the reference until it rests again."""
SLOWEST_MPS = 0.1
_CLOSE_S = (6.6, 8.6)


def slip_at_rates(runs: FigureRuns) -> Entry:
    """Figure 5.10."""
    record = runs.double
    times, truth = true_slip(record)
    moving = (times >= MOVING_S[0]) & (times <= MOVING_S[1])
    by_rate = {rate: measured_slip(record, FULL_HZ // rate) for rate in (FULL_HZ, LOWER_HZ, UPPER_HZ)}
    signal = root_mean_square(truth[moving])
    shares = {rate: 100.0 * _missed(measured, times[moving], truth[moving]) / signal
              for rate, measured in by_rate.items()}  # fmt: skip
    checks = (
        Check("slip yaw rate, true, RMS", signal, 0.03, 0.3, unit="rad/s"),
        Check("share of it missed at 60 Hz", shares[FULL_HZ], 0.0, 40.0, "little", "%"),
        Check("share of it missed at 30 Hz", shares[LOWER_HZ], 0.0, 50.0, unit="%"),
        Check("share of it missed at 5 Hz", shares[UPPER_HZ], 80.0, np.inf, "much", "%"),
    )

    def ratios(drawn: Any) -> None:
        _draw_ratios(drawn, record, by_rate, runs.gauge_m)

    def rates(drawn: Any) -> None:
        _draw_rates(drawn, record, (times, truth), by_rate)

    return Entry(
        "Fig 5.10",
        "Slip at several sampling rates",
        Label.CORRECTED,
        "Simulated. What a 5 Hz layer knows of the slip is a mean over the last 0.2 s, which it holds for the next "
        "0.2 s: where the ground changes, it is as far off as not compensating at all. The 30 Hz layer follows. "
        "The thesis compares 5 and 50 Hz; here the odometry has 60 Hz and its slower samplings average its periods. "
        "The ratios are drawn as printed, but only where the belts run: they are never formed by the stack, "
        "which uses the slip yaw rate below.",
        checks,
        (
            Drawing("Slip ratios", "Of both tracks; what is shaded is the ground under the robot.", ratios, 10.0, 4.2),
            Drawing("Slip yaw rate over the step", "What each rate knows at every instant.", rates, 10.0, 3.2),
        ),
        ("5.2.9", "5.2.9 inputs", "5.2.8"),
        headline=f"{shares[UPPER_HZ]:.0f} % missed at 5 Hz, {shares[FULL_HZ]:.0f} % at 60 Hz",
    )


def _missed(measured: MeasuredSlip, times_s: Array, truth: Array) -> float:
    error = truth - held(measured, times_s)
    return root_mean_square(error[np.isfinite(error)])


def _draw_ratios(drawn: Any, record: RunRecord, by_rate: dict[int, MeasuredSlip], gauge_m: float) -> None:
    axes = drawn.subplots(2, 1, sharex=True, sharey=True)
    styles = {FULL_HZ: {"color": LIMIT, "lw": 0.8}, UPPER_HZ: {"color": variant_colour(0), "lw": 1.5}}
    for rate, style in styles.items():
        measured = by_rate[rate]
        for ax, values in zip(axes, measured.ratios(gauge_m, SLOWEST_MPS), strict=True):
            ax.step(measured.times_s, values, where="post", label=f"{rate} Hz", **style)
    for ax, side in zip(axes, ("left", "right"), strict=True):
        ax.set(ylabel=f"slip ratio, {side}", xlim=MOVING_S)
    axes[-1].set_xlabel("time (s)")
    shade_crossings(axes, record)
    legend_above(drawn, axes)


def _draw_rates(drawn: Any, record: RunRecord, true: tuple[Array, Array], by_rate: dict[int, MeasuredSlip]) -> None:
    axes = drawn.subplots(1, len(by_rate), sharex=True, sharey=True)
    inside = (true[0] >= _CLOSE_S[0]) & (true[0] <= _CLOSE_S[1])
    for index, (ax, (rate, measured)) in enumerate(zip(axes, by_rate.items(), strict=True)):
        ax.plot(true[0][inside], true[1][inside], color=INK, lw=1.0, label="truth")
        known = held(measured, true[0][inside])
        colour = variant_colour((1, 4, 0)[index])
        ax.step(true[0][inside], known, where="post", color=colour, lw=1.4, label=f"known at {rate} Hz")
        ax.set(title=f"{rate} Hz", xlabel="time (s)")
    axes[0].set_ylabel("slip yaw rate (rad/s)")
    shade_crossings(axes, record)
    axes[0].set_xlim(_CLOSE_S)
    legend_above(drawn, axes)
