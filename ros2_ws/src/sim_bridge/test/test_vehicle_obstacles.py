"""Steps, slats, walls and bodies that can be pushed."""

import math

import numpy as np
import pytest

from sim_bridge.solids import Friction, Solid
from sim_bridge.world import World
from tracked_types import Pose2

STEP = World.model_validate(
    {
        "name": "one_step",
        "description": "A step of 40 mm across the way.",
        "objects": [
            {
                "name": "step",
                "shape": "step",
                "position_m": [1.0, 0.0],
                "length_m": 0.4,
                "width_m": 2.0,
                "height_m": 0.04,
            }
        ],
        "starts": {"default": {"x_m": 0.0, "y_m": 0.0}},
    }
)


def crossing(vehicle, duration_s=7.5):
    """Vertical acceleration (m/s2) at every step, low-passed at 50 Hz, and pitch (rad), from first touch on."""
    rate = vehicle.settings.physics_rate_hz
    speeds, pitches, smoothed = [], [], []
    share, once, twice = 1.0 - math.exp(-2.0 * math.pi * 50.0 / rate), 0.0, 0.0
    for _ in range(round(duration_s * rate)):
        vehicle.step(0.3, 0.3)
        state = vehicle.state
        speeds.append(state.velocity_mps[2])
        pitches.append(state.roll_pitch_yaw_rad[1])
    for change in np.diff(speeds):
        once += share * (change * rate - once)
        twice += share * (once - twice)
        smoothed.append(twice)
    return np.array(smoothed[rate:]), np.array(pitches)


def test_x_structure_softens_a_step_that_a_locked_suspension_does_not(make_vehicle):
    shaken = {
        kind: crossing(make_vehicle(STEP, suspension=kind, rate_hz=960))[0] for kind in ("qzs", "linear", "locked")
    }
    rms = {kind: float(np.sqrt(np.mean(values**2))) for kind, values in shaken.items()}
    peak = {kind: float(np.abs(values).max()) for kind, values in shaken.items()}
    assert rms["locked"] > 3.0 * rms["qzs"]
    assert peak["locked"] > 4.5 * peak["qzs"]
    assert rms["qzs"] < rms["linear"] < rms["locked"]


@pytest.mark.parametrize("kind", ["qzs", "linear", "locked"])
def test_step_is_crossed_straight_and_level_again_behind_it(make_vehicle, drive, kind):
    vehicle = make_vehicle(STEP, suspension=kind)
    _, pitches = crossing(vehicle)
    state = drive(vehicle, 0.0, 0.0, 2.0)
    assert -0.35 < pitches.min() < -0.1 and 0.1 < pitches.max() < 0.35
    assert state.base_position_m[0] > 1.8
    assert abs(state.base_position_m[1]) < 0.01 and abs(state.base_pose.yaw_rad) < 0.01
    assert state.base_position_m[2] == pytest.approx(0.0, abs=2e-3)


def test_robot_stands_on_a_step_as_on_the_floor(make_vehicle, drive):
    vehicle = make_vehicle(settle_s=0.0)
    vehicle.entities.spawn(Solid("platform", "box", (2.0, 2.0, 0.002), (0.0, 0.0, 0.001)))
    on_floor = make_vehicle()
    half = 0.5 * vehicle.robot.tracks.gauge_m * 0.8
    drive(vehicle, 0.0, 0.0, 1.0)
    there, here = drive(vehicle, -half, half, 3.0), drive(on_floor, -half, half, 3.0)
    assert there.angular_velocity_radps[2] == pytest.approx(here.angular_velocity_radps[2], rel=0.01)
    assert there.position_m[2] - here.position_m[2] == pytest.approx(0.002, abs=2e-4)


@pytest.mark.parametrize("world", ["step", "slats", "ramp", "ice"])
def test_packaged_course_can_be_driven_straight_through(make_vehicle, drive, world):
    vehicle = make_vehicle(world)
    state = drive(vehicle, 0.4, 0.4, 13.0)
    assert state.base_position_m[0] > 4.5
    assert abs(state.base_position_m[1]) < 0.2
    assert np.abs(state.roll_pitch_yaw_rad[:2]).max() < 0.1


def test_oblique_step_turns_and_rolls_the_robot_but_lets_it_pass(make_vehicle, drive):
    vehicle = make_vehicle(STEP, start=Pose2(0.2, -0.2, 0.35))
    state = drive(vehicle, 0.3, 0.3, 8.0)
    assert state.base_position_m[0] > 1.7
    assert abs(state.base_pose.yaw_rad - 0.35) < 0.2


def test_wall_stops_the_robot(make_vehicle, drive):
    vehicle = make_vehicle()
    vehicle.entities.spawn(Solid("wall", "box", (0.1, 2.0, 1.0), (0.8, 0.0, 0.5)))
    state = drive(vehicle, 0.4, 0.4, 4.0)
    assert 0.35 < state.base_position_m[0] < 0.5
    assert np.abs(state.base_velocity_mps).max() < 0.02


def test_crate_is_pushed_along(make_vehicle, drive):
    vehicle = make_vehicle()
    vehicle.entities.spawn(Solid("crate", "box", (0.3, 0.3, 0.3), (0.6, 0.0, 0.15), mass_kg=2.0))
    drive(vehicle, 0.3, 0.3, 4.0)
    assert vehicle.entities.state("crate").position_m[0] > 1.2


def test_belts_push_a_loose_board_backwards(make_vehicle, drive):
    vehicle = make_vehicle()
    vehicle.entities.spawn(Solid("board", "box", (1.2, 1.0, 0.02), (0.0, 0.0, 0.01), mass_kg=1.0))
    drive(vehicle, 0.0, 0.0, 1.0)
    before = vehicle.entities.state("board").position_m[0]
    drive(vehicle, 0.5, 0.5, 0.2)
    assert vehicle.entities.state("board").position_m[0] < before - 1e-3


def test_slippery_body_slips_more_than_the_floor(make_vehicle, drive):
    def advance(friction):
        vehicle = make_vehicle(settle_s=0.0)
        sheet = Solid("sheet", "box", (4.0, 2.0, 0.01), (0.0, 0.0, 0.005), friction=friction)
        vehicle.entities.spawn(sheet)
        drive(vehicle, 0.0, 0.0, 0.5)
        return drive(vehicle, 0.4, 0.4, 0.6).base_position_m[0]

    assert advance(Friction(longitudinal=0.05, lateral=0.05)) < 0.8 * advance(None)


def test_kerb_beside_a_turning_robot_does_not_launch_it(make_vehicle, drive):
    vehicle = make_vehicle()
    vehicle.entities.spawn(Solid("kerb", "box", (3.0, 0.4, 0.04), (0.0, 0.45, 0.02)))
    for _ in range(12):
        state = drive(vehicle, -0.15, 0.15, 0.5)
        assert state.position_m[2] < 0.25
        assert np.abs(state.roll_pitch_yaw_rad[:2]).max() < 0.35


@pytest.mark.parametrize("kind", ["qzs", "locked"])
@pytest.mark.parametrize("world", ["step", "slats", "ramp", "rooms"])
def test_wild_driving_never_launches_the_robot(make_vehicle, drive, world, kind):
    vehicle = make_vehicle(world, suspension=kind)
    for left, right in np.random.default_rng(11).uniform(-0.3, 0.75, (16, 2)).tolist():
        state = drive(vehicle, left, right, 0.5)
        assert state.position_m[2] < 0.45
        assert np.abs(state.velocity_mps).max() < 1.0
        assert np.abs(state.roll_pitch_yaw_rad[:2]).max() < 0.5
