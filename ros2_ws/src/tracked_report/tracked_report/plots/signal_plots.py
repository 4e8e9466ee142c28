"""Commands, slip and vertical acceleration against time."""

from collections.abc import Mapping

import numpy as np

from tracked_report.metrics.ride import vertical_acceleration
from tracked_report.metrics.settings import MetricSettings
from tracked_report.metrics.sheet import NotRecordedError
from tracked_report.plots.crossings import shade_crossings
from tracked_report.plots.style import INK, LIMIT, legend_above, new_figure, to_svg, variant_colour
from tracked_report.plots.timeline import origin_ns, seconds_after, series
from tracked_report.run_record import RunRecord

Runs = Mapping[str, RunRecord]
_COMMAND_ROWS = (("speed_mps", "speed (m/s)"), ("yaw_rate_radps", "yaw rate (rad/s)"))
_SLIP_ROWS = (("speed_mps", "slip speed (m/s)"), ("yaw_rate_radps", "slip yaw rate (rad/s)"))


def commands(runs: Runs, slug: str) -> str:
    """Commands sent, over the first input of each plan of the upper layer; one column per variant."""
    figure = new_figure(10.0, 4.4)
    axes = figure.subplots(2, len(runs), sharex=True, sharey="row", squeeze=False)
    drawn = False
    for column, (name, record) in enumerate(runs.items()):
        axes[0, column].set_title(name)
        axes[1, column].set_xlabel("time (s)")
        shade_crossings(axes[:, column], record)
        limits = record.meta.limits
        bounds = (
            {"speed_mps": (), "yaw_rate_radps": ()}
            if limits is None
            else {
                "speed_mps": (limits.speed_min_mps, limits.speed_max_mps),
                "yaw_rate_radps": (-limits.yaw_rate_max_radps, limits.yaw_rate_max_radps),
            }
        )
        for row, (key, label) in enumerate(_COMMAND_ROWS):
            ax = axes[row, column]
            for bound in bounds[key]:
                ax.axhline(bound, color=LIMIT, linestyle=(0, (1, 2)), linewidth=1.0)
            for channel, title, style in (
                ("cmd_vel", f"sent to the base, {name}", {"color": variant_colour(column), "linewidth": 1.1}),
                ("upper_plan", "upper layer", {"color": INK, "linewidth": 1.0, "linestyle": (0, (3, 1.5))}),
            ):
                try:
                    times, values = series(record, channel, key)
                except NotRecordedError:
                    continue
                ax.step(times, values, where="post", label=title, **style)
                drawn = True
            axes[row, 0].set_ylabel(label)
    if not drawn:
        raise NotRecordedError("no commands were recorded")
    legend_above(figure, axes.flat)
    return to_svg(figure, slug, "Commands against time")


def slip(runs: Runs, slug: str) -> str:
    """Slip estimate over the truth, one column per variant; unknown slip leaves a gap."""
    figure = new_figure(10.0, 4.4)
    axes = figure.subplots(2, len(runs), sharex=True, sharey="row", squeeze=False)
    drawn = False
    for column, (name, record) in enumerate(runs.items()):
        axes[0, column].set_title(name)
        axes[1, column].set_xlabel("time (s)")
        shade_crossings(axes[:, column], record)
        for row, (key, label) in enumerate(_SLIP_ROWS):
            for channel, title, style in (
                ("truth_slip", "truth", {"color": LIMIT, "linewidth": 2.6}),
                ("slip", f"estimate, {name}", {"color": variant_colour(column), "linewidth": 0.8}),
            ):
                rows = record.channel(channel)
                if not len(rows):
                    continue
                values = np.where(rows.column("known") > 0.5, rows.column(key), np.nan)
                times = seconds_after(rows.stamps_ns, origin_ns(record))
                axes[row, column].plot(times, values, label=title, **style)
                drawn = True
            axes[row, 0].set_ylabel(label)
    if not drawn:
        raise NotRecordedError("no slip was recorded")
    legend_above(figure, axes.flat)
    return to_svg(figure, slug, "Slip estimate and truth against time")


def ride(runs: Runs, slug: str) -> str:
    """Vertical acceleration of the body, all variants together."""
    settings = MetricSettings()
    figure = new_figure(10.0, 2.9)
    ax = figure.subplots()
    drawn = False
    for index, (name, record) in enumerate(runs.items()):
        try:
            stamps, samples = vertical_acceleration(record, settings)
        except NotRecordedError:
            continue
        ax.plot(
            seconds_after(stamps, origin_ns(record)), samples, color=variant_colour(index), label=name, linewidth=0.9
        )
        drawn = True
    if not drawn:
        raise NotRecordedError("no vertical acceleration was recorded")
    shade_crossings([ax], next(iter(runs.values())))
    ax.set(xlabel="time (s)", ylabel="vertical acceleration (m/s²)")
    legend_above(figure, [ax])
    return to_svg(figure, slug, "Vertical acceleration against time")
