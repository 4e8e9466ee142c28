"""Motions that tests feed to sensors, and vehicles that they drive."""

import numpy as np
import pytest

from sim_bridge.physics_settings import PhysicsSettings
from sim_bridge.sensors.mounting import PointMotion
from sim_bridge.sensors.rotations import rotation_from_roll_pitch_yaw
from sim_bridge.vehicle import Vehicle
from sim_bridge.world import load_world
from tracked_description import Robot, load_robot


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


@pytest.fixture
def make_vehicle():
    """Function that makes vehicles and closes them after the test; by default on the flat world, standing settled."""
    made = []

    def make(world="flat", *, rate_hz=480, suspension="robot", robot=None, start=None, settle_s=1.0):
        world = load_world(world) if isinstance(world, str) else world
        settings = PhysicsSettings(physics_rate_hz=rate_hz, suspension=suspension)
        vehicle = Vehicle(robot or load_robot(), world, settings, start)
        made.append(vehicle)
        for _ in range(round(settle_s * rate_hz)):
            vehicle.step(0.0, 0.0)
        return vehicle

    yield make
    for vehicle in made:
        vehicle.close()


@pytest.fixture(scope="session")
def drive():
    """Function that drives a vehicle for some time at two belt speeds; the state afterwards."""

    def run(vehicle, left_mps, right_mps, duration_s):
        for _ in range(round(duration_s * vehicle.settings.physics_rate_hz)):
            vehicle.step(left_mps, right_mps)
        return vehicle.state

    return run


@pytest.fixture(scope="session")
def changed_robot():
    """Function of keywords such as ``suspension={"spring_npm": 4000.0}``: the packaged robot with other numbers."""

    def change(**sections):
        content = load_robot().model_dump()
        for section, values in sections.items():
            content[section].update(values)
        return Robot.model_validate(content)

    return change
