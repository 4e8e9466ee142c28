"""When a run is on something of the scene or turned by force, shaded in the pictures over time."""

from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.path import Path

from tracked_report.metrics.tracking import poses_in_world
from tracked_report.plots.timeline import origin_ns, seconds_after
from tracked_report.run_record import RunRecord
from tracked_types import to_nanoseconds

FORCED = "forced"
GROUND_COLOURS = {"step": "#e0c097", "ramp": "#ead7b7", "friction": "#c9e4f5"}
_COLOURS = {**GROUND_COLOURS, FORCED: "#f4b6c2"}
_LABELS = {"step": "on the step", "ramp": "on the ramp", "friction": "on other friction", FORCED: "turned by force"}
_SHORTEST_S = 0.05


def crossings(record: RunRecord) -> list[tuple[float, float, str]]:
    """Start (s), end (s) and kind of every stretch with the base's centre over a step, ramp or friction patch.

    The sudden change of the pose by force, where the run has one, comes last.
    """
    truth = poses_in_world(record, "truth")
    poses = truth if len(truth) else poses_in_world(record, "odometry")
    if not len(poses):
        return []
    times = seconds_after(poses.stamps_ns, origin_ns(record))
    stretches: list[tuple[float, float, str]] = []
    for outline in record.meta.scene:
        if outline.kind not in GROUND_COLOURS or len(outline.points) < 3:
            continue
        inside = Path(np.array(outline.points)).contains_points(poses.values[:, :2])
        edges = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]]).astype(int)))
        for first, after in zip(edges[::2], edges[1::2], strict=True):
            if times[after - 1] - times[first] > _SHORTEST_S:
                stretches.append((float(times[first]), float(times[after - 1]), outline.kind))
    return stretches + forced(record)


def forced(record: RunRecord) -> list[tuple[float, float, str]]:
    """Start (s) and end (s) of the sudden change of the pose by force, as a stretch; none without one."""
    if record.meta.disturbed_s is None:
        return []
    stamps = np.array([to_nanoseconds(time_s) for time_s in record.meta.disturbed_s], dtype=np.int64)
    start, end = seconds_after(stamps, origin_ns(record)).tolist()
    return [(start, end, FORCED)]


def shade_crossings(axes: Iterable[Axes], record: RunRecord) -> None:
    """Shade the crossings of one run behind the lines of some axes."""
    stretches = crossings(record)
    for ax in axes:
        for start, end, kind in stretches:
            ax.axvspan(start, end, color=_COLOURS[kind], alpha=0.45, linewidth=0, zorder=0, label=_LABELS[kind])
