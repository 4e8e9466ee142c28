"""Axes of the base, seen from a mounted sensor."""

import math


def up_axis(roll_pitch_yaw_rad: tuple[float, float, float]) -> tuple[float, float, float]:
    """The base's upward axis in the frame of a sensor mounted with these fixed-axis angles (REP-103).

    The scalar product with an angular velocity in the sensor's frame is the yaw rate of the base.
    """
    roll, pitch, _ = roll_pitch_yaw_rad
    return (-math.sin(pitch), math.cos(pitch) * math.sin(roll), math.cos(pitch) * math.cos(roll))


def forward_axis(roll_pitch_yaw_rad: tuple[float, float, float]) -> tuple[float, float, float]:
    """The base's forward axis in the frame of a sensor mounted with these fixed-axis angles."""
    roll, pitch, yaw = roll_pitch_yaw_rad
    return (
        math.cos(pitch) * math.cos(yaw),
        math.sin(roll) * math.sin(pitch) * math.cos(yaw) - math.cos(roll) * math.sin(yaw),
        math.cos(roll) * math.sin(pitch) * math.cos(yaw) + math.sin(roll) * math.sin(yaw),
    )


def left_axis(roll_pitch_yaw_rad: tuple[float, float, float]) -> tuple[float, float, float]:
    """The base's axis to the left in the frame of a sensor mounted with these fixed-axis angles."""
    roll, pitch, yaw = roll_pitch_yaw_rad
    return (
        math.cos(pitch) * math.sin(yaw),
        math.sin(roll) * math.sin(pitch) * math.sin(yaw) + math.cos(roll) * math.cos(yaw),
        math.cos(roll) * math.sin(pitch) * math.sin(yaw) - math.sin(roll) * math.cos(yaw),
    )
