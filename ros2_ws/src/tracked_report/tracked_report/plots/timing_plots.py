"""Solver times, loop periods and latency as distributions."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from tracked_report.channel import Array
from tracked_report.metrics.sheet import NotRecordedError
from tracked_report.metrics.timing import LAYERS, latencies_ms, loop
from tracked_report.plots.style import MUTED, legend_above, new_figure, to_svg, variant_colour
from tracked_report.run_record import RunRecord

Runs = Mapping[str, RunRecord]
_LAYER_LINES = {"upper": (0, (4, 2)), "lower": "-"}


def solver_times(runs: Runs, slug: str) -> str:
    """Share of ticks that took no longer than so many milliseconds, per variant and layer."""
    figure = new_figure(10.0, 3.2)
    ax = figure.subplots()
    drawn = False
    for index, (name, record) in enumerate(runs.items()):
        for layer in LAYERS:
            times = record.channel(f"{layer}_status").column("cpu_time_s") * 1e3
            drawn |= _distribution(ax, times, variant_colour(index), f"{name}, {layer} layer", _LAYER_LINES[layer])
    if not drawn:
        raise NotRecordedError("no solver times were recorded")
    ax.set_xscale("log")
    ax.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.xaxis.set_minor_formatter(NullFormatter())
    _shares(ax, "thread CPU time of a tick (ms)")
    legend_above(figure, [ax])
    return to_svg(figure, slug, "Distribution of solver times")


def loop_periods(runs: Runs, slug: str) -> str:
    """Wall-clock periods of the commands, and wall time from an odometry to the command that answers it."""
    figure = new_figure(10.0, 3.2)
    left, right = figure.subplots(1, 2, sharey=True)
    drawn = False
    for index, (name, record) in enumerate(runs.items()):
        waits = latencies_ms(record)
        try:
            periods = loop(record.channel("cmd_vel")).wall_periods_ms
        except NotRecordedError:
            periods = np.zeros(0)
        drawn |= _distribution(left, periods, variant_colour(index), name)
        drawn |= _distribution(right, waits, variant_colour(index), name)
    if not drawn:
        raise NotRecordedError("no arrival times were recorded: the run was made in one process, without a graph")
    _shares(left, "period of the commands on the wall clock (ms)")
    _shares(right, "odometry to command on the wall clock (ms)")
    right.set_ylabel("")
    legend_above(figure, [left, right])
    return to_svg(figure, slug, "Distributions of loop periods and latency")


def _distribution(ax: Axes, samples: Array, colour: str, label: str, linestyle: object = "-") -> bool:
    """Empirical distribution function; whether there was anything to draw."""
    finite = np.sort(samples[np.isfinite(samples)])
    if not len(finite):
        return False
    share = 100.0 * np.arange(1, len(finite) + 1) / len(finite)
    ax.step(finite, share, where="post", color=colour, label=label, linestyle=linestyle)
    return True


def _shares(ax: Axes, label: str) -> None:
    ax.set(xlabel=label, ylabel="share of ticks (%)", ylim=(0.0, 102.0))
    for percent in (50.0, 99.0):
        ax.axhline(percent, color=MUTED, linewidth=0.7, linestyle=(0, (1, 2)))
