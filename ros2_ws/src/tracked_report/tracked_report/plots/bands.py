"""Planned trajectories over time, seen from above."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib import colormaps
from matplotlib.patches import Circle, Polygon
from numpy.typing import NDArray

from tracked_report.plots.style import INK, MUTED, REFERENCE, new_figure, to_svg
from tracked_types import Mover, Pose2, Trajectory

Array = NDArray[np.float64]
EVERY_M = 0.25  # between two drawn outlines of the robot
_TIME_COLOURS = "viridis"


@dataclass(frozen=True, slots=True)
class PlannedBand:
    """What was handed out at one time, why, and the movers as they were then. trajectory: None if there was none."""

    now_s: float
    trajectory: Trajectory | None
    kind: str = "band"
    movers: tuple[Mover, ...] = ()


def bands_over_time(
    planned: Sequence[PlannedBand], slug: str, *, corners: Array, path: Array | None = None, points: Array | None = None
) -> str:
    """SVG of the bands, from dark (first) to light (last); stops in red; the robot where each band begins.

    corners: (k, 2) of the robot's outline in its frame (m). path: (n, 2 or 3) the plan. points: (m, 2) obstacles.

    Raises
    ------
    ValueError: if there is no trajectory among the bands.
    """
    drawn = [each for each in planned if each.trajectory is not None]
    if not drawn:
        raise ValueError("no band has a trajectory to draw")
    figure = new_figure(10.0, 4.5)
    axes = figure.subplots()
    if points is not None and len(points):
        axes.plot(points[:, 0], points[:, 1], ".", color=INK, markersize=2.0, label="obstacles")
    if path is not None and len(path):
        axes.plot(path[:, 0], path[:, 1], "--", color=REFERENCE, linewidth=0.8, label="path")
    shades = colormaps[_TIME_COLOURS](np.linspace(0.0, 0.9, len(drawn)))
    last_place: Array | None = None
    for each, shade in zip(drawn, shades, strict=True):
        assert each.trajectory is not None
        states = each.trajectory.states
        stops = each.kind == "stop"
        axes.plot(states[:, 0], states[:, 1], color="#c81e1e" if stops else shade, linewidth=1.6 if stops else 0.7)
        if last_place is None or np.hypot(*(states[0, :2] - last_place)) >= EVERY_M:
            last_place = states[0, :2]
            outline = Pose2(*states[0].tolist()).transform(corners)
            axes.add_patch(Polygon(outline, closed=True, fill=False, edgecolor=shade, linewidth=0.6))
            for mover in each.movers:
                x, y = mover.position_m.tolist()
                axes.add_patch(Circle((x, y), mover.radius_m, facecolor=shade, edgecolor=MUTED, alpha=0.35))
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("x (m)")
    axes.set_ylabel("y (m)")
    axes.set_title(f"{len(drawn)} bands from {drawn[0].now_s:.1f} s to {drawn[-1].now_s:.1f} s")
    return to_svg(figure, slug, "planned trajectories over time, seen from above")
