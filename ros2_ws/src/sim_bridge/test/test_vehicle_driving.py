"""A robot on the move: slip on straights and turns, drives, friction."""

import math

import numpy as np
import pybullet
import pytest

from sim_bridge.solids import Friction
from sim_bridge.track_speeds import track_targets
from sim_bridge.vehicle import PhysicsDivergedError
from tracked_description import load_robot
from tracked_types import Pose2, Twist2


def coulomb_spot_turn_ratio(robot):
    """Yaw rate over belt yaw rate of two lines of equally loaded wheels under elliptic Coulomb friction."""
    tracks, ground = robot.tracks, robot.ground
    places = tracks.wheel_spacing_m * (np.arange(tracks.wheel_count) - 0.5 * (tracks.wheel_count - 1))
    half = 0.5 * tracks.gauge_m

    def moment(ratio):
        along, across = (ratio - 1.0) * half, ratio * places
        size = np.hypot(ground.friction_longitudinal * along, ground.friction_lateral * across)
        drive = ground.friction_longitudinal**2 * -along * half
        return float(np.sum((drive - ground.friction_lateral**2 * across * places) / size))

    low, high = 0.01, 0.99
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if moment(middle) > 0.0 else (low, middle)
    return low


def spot_turn_ratio(vehicle, drive, yaw_rate):
    half = 0.5 * vehicle.robot.tracks.gauge_m * yaw_rate
    drive(vehicle, -half, half, 2.0)
    yaw, turned = vehicle.state.base_pose.yaw_rad, 0.0
    for _ in range(20):
        new = drive(vehicle, -half, half, 0.1).base_pose.yaw_rad
        turned += math.remainder(new - yaw, math.tau)
        yaw = new
    return turned / (2.0 * yaw_rate)


@pytest.mark.parametrize("yaw_rate", [0.3, -0.6, 1.3])
def test_spot_turn_slips_as_coulomb_friction_has_it(make_vehicle, drive, yaw_rate):
    vehicle = make_vehicle()
    ratio = spot_turn_ratio(vehicle, drive, yaw_rate)
    assert 0.75 < ratio < 0.82
    assert ratio == pytest.approx(coulomb_spot_turn_ratio(vehicle.robot), abs=0.03)


def test_spot_turn_does_not_depend_on_the_step(make_vehicle, drive):
    ratios = [spot_turn_ratio(make_vehicle(rate_hz=rate), drive, 0.8) for rate in (240, 480, 960)]
    assert max(ratios) / min(ratios) < 1.01


def test_spot_turn_turns_on_the_spot(make_vehicle, drive):
    state = drive(make_vehicle(), -0.1, 0.1, 8.0)
    assert np.hypot(*state.base_position_m[:2]) < 1e-3


@pytest.mark.parametrize("speed", [0.4, -0.4])
def test_straight_drive_hardly_slips(make_vehicle, drive, speed):
    vehicle = make_vehicle()
    drive(vehicle, speed, speed, 3.0)
    state = drive(vehicle, speed, speed, 2.0)
    assert state.base_velocity_mps[0] == pytest.approx(state.belt_speed_mps.mean(), rel=2e-3)
    assert abs(state.base_position_m[1]) < 1e-6


def test_turn_is_wider_than_the_belts_say(make_vehicle, drive):
    vehicle = make_vehicle()
    left, right = track_targets(Twist2(0.4, 0.5), vehicle.robot.tracks)
    drive(vehicle, left, right, 4.0)
    yaw_rate = vehicle.state.angular_velocity_radps[2]
    assert 0.7 < yaw_rate / 0.5 < 0.95


def test_mirrored_turn_is_the_mirror_image(make_vehicle, drive):
    one, other = drive(make_vehicle(), 0.2, 0.4, 3.0), drive(make_vehicle(), 0.4, 0.2, 3.0)
    mirrored = other.base_position_m * [1.0, -1.0, 1.0]
    assert one.base_position_m == pytest.approx(mirrored, abs=1e-9)


def test_belt_follows_like_the_first_order_lag_that_controllers_assume(make_vehicle):
    vehicle = make_vehicle()
    tracks, target = vehicle.robot.tracks, 0.3
    profile, lagged, worst = 0.0, 0.0, 0.0
    for _ in range(480):
        vehicle.step(target, target)
        profile = min(profile + tracks.acceleration_limit_mps2 * vehicle.period_s, target)
        lagged += (profile - lagged) * (1.0 - math.exp(-vehicle.period_s / tracks.motor_time_constant_s))
        worst = max(worst, abs(vehicle.state.belt_speed_mps[0] - lagged))
    assert worst < 0.02
    assert vehicle.state.belt_speed_mps[0] == pytest.approx(target, abs=0.003)


def test_belt_acceleration_stays_within_its_limit(make_vehicle):
    vehicle = make_vehicle()
    limit = vehicle.robot.tracks.acceleration_limit_mps2
    speeds = [0.0]
    for target in (0.7, -0.7):
        for _ in range(480):
            vehicle.step(target, target)
            speeds.append(vehicle.state.belt_speed_mps[0])
    assert np.abs(np.diff(speeds)).max() * 480 < 1.1 * limit


def test_belt_never_runs_faster_than_its_limit(make_vehicle, drive):
    vehicle = make_vehicle()
    assert drive(vehicle, 5.0, 5.0, 2.0).belt_speed_mps == pytest.approx([0.75, 0.75], abs=0.005)


def test_motor_force_is_limited_against_a_wall(make_vehicle, drive, changed_robot):
    vehicle = make_vehicle("rooms", robot=changed_robot(tracks={"force_limit_n": 20.0}))
    state = drive(vehicle, -0.4, -0.4, 5.0)
    assert np.abs(state.motor_force_n).max() <= 20.0
    assert state.base_position_m[0] > 0.25, "the wall stands at x = 0"
    assert np.abs(state.belt_speed_mps).max() < 0.05, "20 N cannot make the belts slide on the floor"


def test_belt_recovers_at_once_when_a_stalled_target_turns(make_vehicle, drive, changed_robot):
    vehicle = make_vehicle("rooms", robot=changed_robot(tracks={"force_limit_n": 20.0}))
    drive(vehicle, -0.4, -0.4, 5.0)
    assert drive(vehicle, 0.3, 0.3, 0.6).belt_speed_mps.min() > 0.2


def test_encoders_count_belt_travel_not_ground_travel(make_vehicle, drive):
    vehicle = make_vehicle()
    start = drive(vehicle, -0.1, 0.1, 2.0)
    state = drive(vehicle, -0.1, 0.1, 5.0)
    assert state.belt_travel_m - start.belt_travel_m == pytest.approx([-0.5, 0.5], abs=0.002)
    turned = (math.remainder(state.base_pose.yaw_rad - start.base_pose.yaw_rad, math.tau)) % math.tau
    assert turned * 0.36 < 0.85, "a belt travel of 1 m in all over a gauge of 0.36 m, and slip"


def test_low_friction_makes_a_start_slip(make_vehicle, drive):
    grip, ice = make_vehicle(), make_vehicle()
    ice.set_friction(Friction(longitudinal=0.05, lateral=0.05))
    assert drive(ice, 0.4, 0.4, 0.5).base_velocity_mps[0] < 0.7 * drive(grip, 0.4, 0.4, 0.5).base_velocity_mps[0]


def test_zone_under_one_track_turns_the_robot(make_vehicle, drive):
    def yaw_after_start(zone_friction):
        vehicle = make_vehicle("ice", settle_s=0.0)
        vehicle.set_friction(Friction(longitudinal=zone_friction, lateral=zone_friction), "strip")
        vehicle.place(Pose2(3.6, 0.12, 0.0))
        return drive(vehicle, 0.5, 0.5, 0.6).base_pose.yaw_rad

    assert yaw_after_start(0.05) > 0.01
    assert abs(yaw_after_start(0.75)) < 0.01


def test_unknown_zone_is_refused_by_name(make_vehicle):
    with pytest.raises(ValueError, match="no friction zone 'lake'; there are: sheet, strip, rink"):
        make_vehicle("ice").set_friction(Friction(longitudinal=0.1, lateral=0.1), "lake")


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_target_that_is_no_number_is_refused(make_vehicle, bad):
    vehicle = make_vehicle()
    for targets in ((bad, 0.0), (0.0, bad)):
        with pytest.raises(ValueError, match="finite"):
            vehicle.step(*targets)
    vehicle.step(0.0, 0.0)


def test_diverged_state_is_an_error_not_a_result(make_vehicle):
    vehicle = make_vehicle()
    pybullet.setGravity(0.0, 0.0, math.inf, physicsClientId=vehicle.client)
    with pytest.raises(PhysicsDivergedError, match="step 481"):
        vehicle.step(0.1, 0.1)


@pytest.mark.parametrize(
    ("twist", "expected"),
    [
        (Twist2(0.4, 0.0), (0.4, 0.4)),
        (Twist2(0.0, 1.0), (-0.18, 0.18)),
        (Twist2(0.6, 2.0), (0.75 * 0.24 / 0.96, 0.75)),
        (Twist2(-0.9, 0.0), (-0.75, -0.75)),
    ],
)
def test_twist_becomes_belt_speeds_with_its_radius_kept(twist, expected):
    assert track_targets(twist, load_robot().tracks) == pytest.approx(expected)


def test_a_torque_turns_a_standing_robot_only_if_it_is_stronger_than_the_tracks_grip(make_vehicle, drive):
    turned = []
    for torque in (2.0, -30.0):
        vehicle = make_vehicle()
        vehicle.yaw_torque_nm = torque
        turned.append(drive(vehicle, 0.0, 0.0, 0.3).base_pose.yaw_rad)
        vehicle.yaw_torque_nm = 0.0
        at_rest = drive(vehicle, 0.0, 0.0, 1.0)
        assert abs(at_rest.angular_velocity_radps[2]) < 1e-3
    assert abs(turned[0]) < 0.01
    assert turned[1] < -0.3


def test_a_reset_ends_the_torque(make_vehicle):
    vehicle = make_vehicle()
    vehicle.yaw_torque_nm = 30.0
    vehicle.reset()
    assert vehicle.yaw_torque_nm == 0.0
