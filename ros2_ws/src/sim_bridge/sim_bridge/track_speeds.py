"""From the twist of the base to the speeds of its two belts."""

from tracked_description.robot import Tracks
from tracked_types import Twist2


def track_targets(twist: Twist2, tracks: Tracks) -> tuple[float, float]:
    """Belt speeds (left, right; m/s) that a twist asks for, (5.2.2)-(5.2.3).

    If either is beyond the belts' limit both are reduced by the same factor, so that the radius of the turn is kept.
    """
    turning = 0.5 * tracks.gauge_m * twist.yaw_rate_radps
    left, right = twist.speed_mps - turning, twist.speed_mps + turning
    fastest = max(abs(left), abs(right))
    if fastest <= tracks.speed_limit_mps:
        return left, right
    factor = tracks.speed_limit_mps / fastest
    return left * factor, right * factor
