"""Motions that tests feed to sensors."""

import numpy as np
import pytest

from sim_bridge.sensors.mounting import PointMotion
from sim_bridge.sensors.rotations import rotation_from_roll_pitch_yaw


def _motion(position=(0.0, 0.0, 0.0), rpy=(0.0, 0.0, 0.0), velocity=(0.0, 0.0, 0.0), rates=(0.0, 0.0, 0.0)):
    return PointMotion(
        np.array(position, float), rotation_from_roll_pitch_yaw(*rpy), np.array(velocity, float), np.array(rates, float)
    )


def _circling(time_s, yaw_rate, radius):
    yaw = yaw_rate * time_s
    speed = yaw_rate * radius
    return _motion(
        position=(radius * np.sin(yaw), -radius * np.cos(yaw), 0.0),
        rpy=(0.0, 0.0, yaw),
        velocity=(speed * np.cos(yaw), speed * np.sin(yaw), 0.0),
        rates=(0.0, 0.0, yaw_rate),
    )


@pytest.fixture(scope="session")
def motion():
    """Function that makes a PointMotion; by default at rest in the origin."""
    return _motion


@pytest.fixture(scope="session")
def circling():
    """Function of (time_s, yaw_rate, radius): counter-clockwise about the origin, looking along the path."""
    return _circling
