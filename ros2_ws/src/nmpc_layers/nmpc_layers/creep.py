"""Commands too small to be meant: a robot that holds its place stands still instead of creeping."""

from tracked_types import Twist2

CREEP_SPEED_MPS = 0.005
CREEP_YAW_RATE_RADPS = 0.02


def without_creep(twist: Twist2) -> Twist2:
    """``twist``, or rest where both its parts are below what belts are asked for on purpose.

    At rest the noise of the pose asks for millimetres per second. Encoders do not see belts that turn so
    slowly, so the odometry filter would take the turn for gyro bias while it learns the bias of a robot
    that it believes to stand.
    """
    if abs(twist.speed_mps) < CREEP_SPEED_MPS and abs(twist.yaw_rate_radps) < CREEP_YAW_RATE_RADPS:
        return Twist2(0.0, 0.0)
    return twist
