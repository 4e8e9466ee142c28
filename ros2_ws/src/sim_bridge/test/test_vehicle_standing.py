"""A robot at rest: statics, slopes, and loads that it cannot carry."""

import numpy as np
import pybullet
import pytest

from robust_core.plants.x_structure import STANDARD_GRAVITY_MPS2, SnapThroughError
from tracked_description import load_robot
from tracked_description.suspension import rest_travel_m
from tracked_types import Pose2

KINDS = ["qzs", "linear", "locked"]


def whole_weight(robot):
    wheels = 2 * robot.tracks.wheel_count
    return (robot.chassis.sprung_mass_kg + wheels * robot.chassis.unit_mass_kg) * STANDARD_GRAVITY_MPS2


@pytest.mark.parametrize("kind", ["qzs", "linear"])
def test_ground_carries_the_whole_weight_evenly(make_vehicle, kind):
    vehicle = make_vehicle(suspension=kind, settle_s=3.0)
    loads = vehicle.belt_loads_n
    assert loads.sum() == pytest.approx(whole_weight(vehicle.robot), rel=1e-3)
    assert loads[0] == pytest.approx(loads[1], rel=1e-6)
    assert loads[0] == pytest.approx(loads[0, ::-1], abs=0.02)


@pytest.mark.parametrize("kind", ["qzs", "linear"])
def test_suspension_sags_to_its_equilibrium(make_vehicle, kind):
    vehicle = make_vehicle(suspension=kind, settle_s=3.0)
    expected = rest_travel_m(vehicle.robot, kind)
    assert vehicle.state.suspension_travel_m == pytest.approx(np.full(10, expected), abs=2e-4)


@pytest.mark.parametrize("kind", KINDS)
def test_base_rests_on_the_floor_and_stays_there(make_vehicle, drive, kind):
    start = Pose2(1.0, -2.0, 0.7)
    vehicle = make_vehicle(suspension=kind, start=start)
    state = drive(vehicle, 0.0, 0.0, 2.0)
    assert state.base_position_m == pytest.approx([1.0, -2.0, 0.0], abs=1.5e-3)
    assert state.base_pose.yaw_rad == pytest.approx(0.7, abs=1e-6)
    assert np.abs(state.base_velocity_mps).max() < 1e-4


@pytest.mark.parametrize("kind", KINDS)
def test_slope_is_held_without_creeping(make_vehicle, drive, kind):
    vehicle = make_vehicle("ramp", suspension=kind)
    drive(vehicle, 0.3, 0.3, 4.2)
    before = drive(vehicle, 0.0, 0.0, 3.0)
    after = drive(vehicle, 0.0, 0.0, 3.0)
    assert before.roll_pitch_yaw_rad[1] < -0.16, "the robot should stand on the slope by now"
    assert np.linalg.norm(after.position_m - before.position_m) < 1e-4
    assert np.abs(after.belt_speed_mps).max() < 1e-6


def test_slope_steeper_than_friction_is_not_held(make_vehicle, drive):
    vehicle = make_vehicle()
    steep = np.arctan(1.2 * vehicle.robot.ground.friction_longitudinal)
    gravity = STANDARD_GRAVITY_MPS2 * np.array([-np.sin(steep), 0.0, -np.cos(steep)])
    pybullet.setGravity(*gravity, physicsClientId=vehicle.client)
    assert drive(vehicle, 0.0, 0.0, 2.0).velocity_mps[0] < -0.5


def test_load_beyond_snap_through_is_refused_with_the_reason(make_vehicle, changed_robot):
    heavy = changed_robot(chassis={"sprung_mass_kg": 25.0})
    with pytest.raises(SnapThroughError, match=r"24\.52 N per unit snaps .* less than 21\.49 N"):
        make_vehicle(robot=heavy)


def test_heavy_robot_is_refused_when_the_law_changes_and_keeps_its_own(make_vehicle, changed_robot):
    vehicle = make_vehicle(robot=changed_robot(chassis={"sprung_mass_kg": 25.0}), suspension="linear")
    with pytest.raises(SnapThroughError):
        vehicle.set_suspension("qzs")
    assert vehicle.suspension == "linear"


def test_spring_that_rests_on_its_stop_is_refused(make_vehicle, changed_robot):
    with pytest.raises(ValueError, match="stop"):
        make_vehicle(robot=changed_robot(suspension={"linear_spring_npm": 100.0}), suspension="linear")


def test_locked_suspension_refuses_a_coarse_step(make_vehicle):
    with pytest.raises(ValueError, match=r"locked.*at least 361 Hz, got 240 Hz"):
        make_vehicle(suspension="locked", rate_hz=240)


@pytest.mark.parametrize("kind", KINDS)
def test_changing_the_law_at_rest_moves_nothing(make_vehicle, drive, kind):
    vehicle = make_vehicle(settle_s=2.0)
    before = vehicle.state.position_m
    vehicle.set_suspension(kind)
    after = drive(vehicle, 0.0, 0.0, 2.0).position_m
    assert after == pytest.approx(before, abs=1e-3)


def test_file_with_another_wheel_count_works(make_vehicle, drive, changed_robot):
    robot = changed_robot(tracks={"wheel_count": 4, "wheel_spacing_m": 0.13})
    vehicle = make_vehicle(robot=robot)
    assert vehicle.belt_loads_n.sum() == pytest.approx(whole_weight(robot), rel=0.01)
    assert drive(vehicle, 0.3, 0.3, 2.0).velocity_mps[0] == pytest.approx(0.3, abs=0.01)


def test_packaged_robot_uses_the_thesis_law():
    assert load_robot().suspension.kind == "qzs"
