"""States, tracking errors and the scene from above."""

from collections.abc import Mapping

import numpy as np
from matplotlib.patches import Polygon

from tracked_report.metrics.settings import MetricSettings
from tracked_report.metrics.sheet import NotRecordedError
from tracked_report.metrics.tracking import FRAMES, Tracking, poses_in_world, tracking
from tracked_report.plots.crossings import FORCED, GROUND_COLOURS, crossings, shade_crossings
from tracked_report.plots.style import (
    INK,
    REFERENCE,
    TRUTH,
    legend_above,
    new_figure,
    to_svg,
    variant_colour,
)
from tracked_report.plots.timeline import origin_ns, seconds_after
from tracked_report.run_record import RunRecord

Runs = Mapping[str, RunRecord]
_DASHED = (0, (4, 2))
_STATE_LABELS = ("x (m)", "y (m)", "heading (rad)")
_ERROR_LABELS = ("x error (m)", "y error (m)", "heading error (rad)")
_KIND_COLOURS = {
    "wall": "#52606d",
    "obstacle": "#9aa5b1",
    "movable": "#d6c6e8",
    **GROUND_COLOURS,
}


def _tracked(record: RunRecord, frame: str, settings: MetricSettings) -> Tracking | None:
    try:
        return tracking(record, "estimated" if frame == "estimated" else "true", settings)
    except NotRecordedError:
        return None


def states(runs: Runs, slug: str) -> str:
    """Reference, estimate and truth of x, y and heading, one column per variant."""
    settings = MetricSettings()
    figure = new_figure(10.0, 5.6)
    axes = figure.subplots(3, len(runs), sharex=True, sharey="row", squeeze=False)
    drawn = False
    for column, (name, record) in enumerate(runs.items()):
        axes[0, column].set_title(name)
        axes[2, column].set_xlabel("time (s)")
        shade_crossings(axes[:, column], record)
        for frame, colour, label in (
            ("true", TRUTH, "truth"),
            ("estimated", variant_colour(column), f"estimate, {name}"),
        ):
            run = _tracked(record, frame, settings)
            if run is None:
                continue
            drawn = True
            times = seconds_after(run.stamps_ns, origin_ns(record))
            wanted = run.reference.copy()
            wanted[:, 2] = np.unwrap(wanted[:, 2])
            for row in range(3):
                # The reference minus the wrapped error keeps both headings on one branch.
                axes[row, column].plot(times, wanted[:, row] - run.error[:, row], color=colour, label=label)
                if frame == "estimated" or _tracked(record, "estimated", settings) is None:
                    style = {"color": REFERENCE, "linestyle": _DASHED, "linewidth": 1.1}
                    axes[row, column].plot(times, wanted[:, row], label="reference", **style)
    if not drawn:
        raise NotRecordedError("no run has a reference together with poses")
    for row, label in enumerate(_STATE_LABELS):
        axes[row, 0].set_ylabel(label)
    legend_above(figure, axes.flat)
    return to_svg(figure, slug, "States against time")


def transient(runs: Runs, slug: str) -> str:
    """y and heading around what pushed the robot: all estimates, one reference.

    The sudden change of the pose by force, 0.4 s before until 0.6 s after as Fig 5.22 (b); in runs without one the
    first step crossed, a second before until two after.
    """
    first = next(iter(runs.values()))
    stretches = {kind: (start, end) for start, end, kind in reversed(crossings(first))}
    if FORCED in stretches:
        (start, end), before, after = stretches[FORCED], 0.4, 0.6
    elif "step" in stretches:
        (start, end), before, after = stretches["step"], 1.0, 2.0
    else:
        raise NotRecordedError("no step was crossed, and nothing turned the robot by force")
    window = (start - before, end + after)
    figure = new_figure(10.0, 2.9)
    axes = figure.subplots(1, 2)
    for index, (name, record) in enumerate(runs.items()):
        run = _tracked(record, "estimated", MetricSettings())
        if run is None:
            continue
        times = seconds_after(run.stamps_ns, origin_ns(record))
        inside = (times >= window[0]) & (times <= window[1])
        wanted = run.reference[inside].copy()
        wanted[:, 2] = np.unwrap(wanted[:, 2])
        for ax, row in zip(axes, (1, 2), strict=True):
            ax.plot(times[inside], wanted[:, row] - run.error[inside, row], color=variant_colour(index), label=name)
            if index == 0:
                ax.plot(times[inside], wanted[:, row], color=REFERENCE, linestyle=_DASHED, label="reference", zorder=4)
    for ax, row in zip(axes, (1, 2), strict=True):
        ax.set(xlabel="time (s)", ylabel=_STATE_LABELS[row], xlim=window)
    shade_crossings(axes, first)
    legend_above(figure, axes)
    return to_svg(figure, slug, "y and heading against time around a push")


def errors(runs: Runs, slug: str) -> str:
    """Errors of x, y and heading: estimated frame left, true frame right, all variants together."""
    settings = MetricSettings()
    figure = new_figure(10.0, 5.6)
    axes = figure.subplots(3, 2, sharex=True, sharey="row", squeeze=False)
    drawn = False
    for column, frame in enumerate(FRAMES):
        axes[0, column].set_title(f"{frame} frame")
        axes[2, column].set_xlabel("time (s)")
        for index, (name, record) in enumerate(runs.items()):
            run = _tracked(record, frame, settings)
            if run is None:
                continue
            drawn = True
            times = seconds_after(run.stamps_ns, origin_ns(record))
            for row in range(3):
                axes[row, column].plot(times, run.error[:, row], color=variant_colour(index), label=name)
        for row in range(3):
            axes[row, column].axhline(0.0, color=INK, linewidth=0.7)
    if not drawn:
        raise NotRecordedError("no run has a reference together with poses")
    shade_crossings(axes.flat, next(iter(runs.values())))
    for row, label in enumerate(_ERROR_LABELS):
        axes[row, 0].set_ylabel(label)
    legend_above(figure, axes.flat)
    return to_svg(figure, slug, "Tracking errors against time")


def scene(runs: Runs, slug: str) -> str:
    """The world from above with the reference and the true paths (estimated ones where there is no truth)."""
    paths, points = {}, []
    for name, record in runs.items():
        source = "truth" if len(record.channel("truth").clean()) else "odometry"
        path = poses_in_world(record, source).values[:, :2]
        if len(path):
            paths[name] = (path, "true path" if source == "truth" else "estimated path")
            points.append(path)
    if not paths:
        raise NotRecordedError("no run has poses")
    first = next(iter(runs.values()))
    wanted = poses_in_world(first, "reference").values[:, :2]
    points += [wanted] if len(wanted) else []
    low, high = np.vstack(points).min(axis=0) - 0.6, np.vstack(points).max(axis=0) + 0.6
    width, height = high - low
    figure = new_figure(10.0, float(np.clip(10.0 * height / width + 0.5, 2.6, 8.0)))
    ax = figure.subplots()
    for outline in first.meta.scene:
        colour = _KIND_COLOURS[outline.kind]
        ax.add_patch(Polygon(outline.points, closed=True, facecolor=colour, edgecolor="none", zorder=1))
        corners = np.clip(np.array(outline.points), low, high)
        if outline.label and np.ptp(corners, axis=0).min() > 0.0:
            x, y = corners[:, 0].mean(), corners[:, 1].max()
            ax.annotate(outline.label, (x, y), (0, -4), textcoords="offset points", ha="center", va="top", fontsize=8)
    if len(wanted):
        ax.plot(*wanted.T, color=REFERENCE, linestyle=_DASHED, linewidth=1.2, label="reference", zorder=4)
    for index, (name, (path, kind)) in enumerate(paths.items()):
        ax.plot(*path.T, color=variant_colour(index), label=f"{name}, {kind}", linewidth=1.6, zorder=3)
    start = next(iter(paths.values()))[0][0]
    ax.plot(*start, marker="o", color=INK, markersize=6, linestyle="none", label="start", zorder=5)
    if len(wanted):
        ax.plot(*wanted[-1], marker="*", color=INK, markersize=10, linestyle="none", label="goal", zorder=5)
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), xlabel="x (m)", ylabel="y (m)", aspect="equal")
    legend_above(figure, [ax])
    return to_svg(figure, slug, "World from above with the paths driven")
