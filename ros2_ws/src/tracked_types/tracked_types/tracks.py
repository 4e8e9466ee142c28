"""Belt encoders of a track pair."""

from dataclasses import dataclass

LEFT_TRACK, RIGHT_TRACK = "left_track", "right_track"  # joints of the URDF; sensors are called so too


@dataclass(frozen=True, slots=True)
class TrackSample:
    """Belt travel (m) and belt speed (m/s) of both tracks, as their encoders see them.

    Belt motion, not ground motion: the difference between the two is slip.
    """

    stamp_ns: int
    left_travel_m: float
    right_travel_m: float
    left_speed_mps: float
    right_speed_mps: float
