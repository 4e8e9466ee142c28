"""A track laid over GPS: turned and shifted to fit the beginning, compared over the whole."""

import math
from dataclasses import dataclass

import numpy as np

from tracked_lab.recordings.recording_file import Array

ALIGNED_S = 60.0


@dataclass(frozen=True, slots=True)
class GpsComparison:
    """track_m (k, 2): the track at the GPS times, laid over GPS. distance_m (k,): between the two."""

    track_m: Array
    distance_m: Array

    @property
    def mean_m(self) -> float:
        """Mean distance over the whole."""
        return float(self.distance_m.mean())

    @property
    def largest_m(self) -> float:
        """Largest distance."""
        return float(self.distance_m.max())

    @property
    def end_m(self) -> float:
        """Distance at the end."""
        return float(self.distance_m[-1])


def compare_with_gps(
    times_s: Array, positions_m: Array, gps_s: Array, gps_m: Array, aligned_s: float = ALIGNED_S
) -> GpsComparison:
    """Turn and shift a track, least squares over the fixes of the first ``aligned_s``, and compare.

    times_s (n,), positions_m (n, 2): the track in its own frame. gps_s (k,), gps_m (k, 2): fixes.

    Raises
    ------
    ValueError: if fewer than two fixes lie in that time.
    """
    at_fixes = np.stack([np.interp(gps_s, times_s, positions_m[:, axis]) for axis in (0, 1)], axis=1)
    early = gps_s <= aligned_s
    if early.sum() < 2:
        raise ValueError(f"fewer than two fixes in the first {aligned_s:g} s")
    centre, gps_centre = at_fixes[early].mean(axis=0), gps_m[early].mean(axis=0)
    own, other = at_fixes[early] - centre, gps_m[early] - gps_centre
    angle = math.atan2(float(np.sum(own[:, 0] * other[:, 1] - own[:, 1] * other[:, 0])), float(np.sum(own * other)))
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    laid = (at_fixes - centre) @ turn.T + gps_centre
    return GpsComparison(laid, np.linalg.norm(laid - gps_m, axis=1))
