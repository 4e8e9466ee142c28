"""Poses that fit all edges best: GTSAM behind one function, loaded when it is first needed."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tracked_localization.pose_graph.key_scan import Edge
from tracked_types import Pose2, wrap_angle

Array = NDArray[np.float64]
_FIXED = 1e-6
_ROBUST_FROM = 1.0


def fitted(poses: Sequence[Pose2], motions: Sequence[Edge], loops: Sequence[Edge]) -> list[Pose2]:
    """Most likely poses given ``motions`` and, with Cauchy's robust weight, ``loops``; the first pose stays.

    Levenberg-Marquardt from ``poses``.

    Raises
    ------
    ValueError: if an edge names a pose that does not exist, or its numbers cannot be used.
    """
    for edge in (*motions, *loops):
        if not (0 <= edge.start < len(poses) and 0 <= edge.end < len(poses)) or edge.start == edge.end:
            raise ValueError(f"edge from {edge.start} to {edge.end}: there are {len(poses)} poses")
        if not np.isfinite(edge.pose.as_array()).all() or np.linalg.eigvalsh(edge.information).min() <= 0.0:
            raise ValueError(f"edge from {edge.start} to {edge.end}: pose or information cannot be used")
    gtsam = load_solver()
    graph, start = gtsam.NonlinearFactorGraph(), gtsam.Values()
    for index, pose in enumerate(poses):
        start.insert(index, _pose(gtsam, pose))
    fixed = gtsam.noiseModel.Isotropic.Sigma(3, _FIXED)
    graph.add(gtsam.PriorFactorPose2(0, _pose(gtsam, poses[0]), fixed))
    kernel = gtsam.noiseModel.mEstimator.Cauchy.Create(_ROBUST_FROM)
    for edge in motions:
        graph.add(gtsam.BetweenFactorPose2(edge.start, edge.end, _pose(gtsam, edge.pose), _noise(gtsam, edge)))
    for edge in loops:
        noise = gtsam.noiseModel.Robust.Create(kernel, _noise(gtsam, edge))
        graph.add(gtsam.BetweenFactorPose2(edge.start, edge.end, _pose(gtsam, edge.pose), noise))
    found = gtsam.LevenbergMarquardtOptimizer(graph, start).optimize()
    return [_back(found.atPose2(index)) for index in range(len(poses))]


def load_solver() -> Any:
    """Load GTSAM now instead of when the first loop closes: it takes a third of a second and 50 MB."""
    import gtsam

    return gtsam


def misfit(poses: Sequence[Pose2], edge: Edge) -> float:
    """Squared distance between an edge and the poses, in standard deviations of the edge (chi-square, 3)."""
    between = poses[edge.start].inverse().compose(poses[edge.end])
    off = edge.pose.inverse().compose(between).as_array()
    off[2] = wrap_angle(float(off[2]))
    return float(off @ edge.information @ off)


def _pose(gtsam: Any, pose: Pose2) -> Any:
    return gtsam.Pose2(pose.x_m, pose.y_m, pose.yaw_rad)


def _back(pose: Any) -> Pose2:
    return Pose2(float(pose.x()), float(pose.y()), float(pose.theta()))


def _noise(gtsam: Any, edge: Edge) -> Any:
    return gtsam.noiseModel.Gaussian.Information(np.ascontiguousarray(edge.information))
