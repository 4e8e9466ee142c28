"""What the state of the odometry filter says of the robot over ground."""

from tracked_localization.settings import OdometryFilterSettings
from tracked_localization.state import SHARE, SPEED, YAW, YAW_RATE, Array, X, Y
from tracked_types import Odometry, Pose2, Twist2


def odometry_of(
    state: Array, covariance: Array, settings: OdometryFilterSettings, stamp_ns: int, *, share_is_learnt: bool
) -> Odometry:
    """State (11,) and covariance (11, 11) as odometry.

    Where poses show the share that the ground takes of the belts' speed, the twist is that over ground.
    """
    speed = float(state[SPEED])
    twist_covariance = covariance[SPEED : YAW_RATE + 1, SPEED : YAW_RATE + 1].copy()
    if share_is_learnt:
        kept = 1.0 - float(state[SHARE])
        both = float(covariance[SPEED, SHARE])
        twist_covariance[0] *= kept
        twist_covariance[0, 1] -= speed * float(covariance[SHARE, YAW_RATE])
        twist_covariance[1, 0] = twist_covariance[0, 1]
        # Never below nothing, where rounding of a strong correlation would have it.
        along = kept * twist_covariance[0, 0] - 2.0 * kept * speed * both + speed**2 * float(covariance[SHARE, SHARE])
        twist_covariance[0, 0] = max(along, 0.0)
        speed *= kept
    return Odometry(
        stamp_ns=stamp_ns,
        frame_id=settings.odom_frame,
        child_frame_id=settings.base_frame,
        pose=Pose2(float(state[X]), float(state[Y]), float(state[YAW])),
        twist=Twist2(speed, float(state[YAW_RATE])),
        pose_covariance=covariance[:3, :3].copy(),
        twist_covariance=twist_covariance,
    )
