"""Belt encoders of a track pair."""

from dataclasses import dataclass

LEFT_TRACK, RIGHT_TRACK = "left_track", "right_track"  # joints of the URDF; sensors are called so too


@dataclass(frozen=True, slots=True)
class TrackSample:
    """Belt travel (m) of both tracks, as their encoders see them; belt speed (m/s) where the driver tells it.

    Belt motion, not ground motion: the difference between the two is slip. Speeds are for records; estimates take the
    travel, which has no noise of its own.
    """

    stamp_ns: int
    left_travel_m: float
    right_travel_m: float
    left_speed_mps: float | None = None
    right_speed_mps: float | None = None
