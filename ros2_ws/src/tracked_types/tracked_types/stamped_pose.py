"""Pose that somebody asks for or reports."""

from dataclasses import dataclass

from tracked_types.pose import Pose2


@dataclass(frozen=True, slots=True)
class StampedPose:
    """A planar pose in ``frame_id`` as of ``stamp_ns``; a goal's stamp may be zero, which means now."""

    stamp_ns: int
    frame_id: str
    pose: Pose2
