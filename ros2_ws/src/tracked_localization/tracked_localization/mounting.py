"""Which way is up for a mounted sensor."""

import math


def up_axis(roll_pitch_yaw_rad: tuple[float, float, float]) -> tuple[float, float, float]:
    """The base's upward axis in the frame of a sensor mounted with these fixed-axis angles (REP-103).

    The scalar product with an angular velocity in the sensor's frame is the yaw rate of the base.
    """
    roll, pitch, _ = roll_pitch_yaw_rad
    return (-math.sin(pitch), math.cos(pitch) * math.sin(roll), math.cos(pitch) * math.cos(roll))
