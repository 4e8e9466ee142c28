"""The plant itself, and both control layers in closed loop on it."""

from collections.abc import Iterator

import numpy as np
import pytest

from nmpc_layers import Phase
from sim_bridge.command_intake import CommandRefused
from tracked_description import load_robot
from tracked_lab import Reaction, Stack
from tracked_lab.closed_loop import ClosedLoop
from tracked_lab.kinematic_ground import Ground
from tracked_lab.kinematic_motion import SUBSTEPS
from tracked_lab.kinematic_plant import KinematicPlant
from tracked_lab.steering import NmpcLayers
from tracked_lab.tracking import tracking_error
from tracked_types import Twist2, VelocityCommand, angle_difference

ROBOT = load_robot()
SEEDS = (1100, 1101, 1102)
BEGIN_S = 2.0  # of the player's reference


def run(seed, stack: Stack, duration_s=14.0) -> Iterator[Reaction]:
    """Closed loop of stack and plant; what the stack did at each odometry."""
    loop = ClosedLoop(KinematicPlant(ROBOT, seed, Ground.of_seed(seed, obstacle=True, begin_s=BEGIN_S)), stack)
    for _ in range(round(ROBOT.imu.rate_hz * duration_s)):
        yield from loop.tick()


def make_stack(layers="double", method="improved", upper=None, lower=None, **shape) -> Stack:
    return Stack(
        ROBOT,
        {
            "trajectory_player": shape,
            "upper_nmpc": {"layers": layers, "method": method, **(upper or {})},
            "lower_nmpc": {"method": method, **(lower or {})},
        },
    )


def rms_errors(seeds=SEEDS, **layers):
    """RMS of estimated minus reference pose over the trajectory, mean over seeds, shape (3,)."""
    results = []
    for seed in seeds:
        stack, errors, piece = make_stack(swings=2, **layers), [], None
        for reaction in run(seed, stack):
            piece = reaction.player.reference or piece
            if 0.0 < stack.player.progress < 1.0:
                errors.append(tracking_error(reaction.estimate.odometry, piece))
        results.append(np.sqrt(np.mean(np.square(errors), axis=0)))
    return np.mean(results, axis=0)


def off_goal(stack: Stack, last: Reaction) -> tuple[float, float]:
    """Distance (m) and turn (rad) left to the end of the trajectory."""
    goal, pose = stack.player.goal, last.estimate.odometry.pose
    turned = abs(angle_difference(goal.yaw_rad, pose.yaw_rad))
    return float(np.hypot(goal.x_m - pose.x_m, goal.y_m - pose.y_m)), turned


@pytest.fixture(scope="module")
def improved():
    return rms_errors()


def test_equal_seeds_and_commands_give_equal_samples():
    def samples(seed):
        plant = KinematicPlant(ROBOT, seed)
        plant.submit(VelocityCommand(0, Twist2(0.3, 0.5)))
        batches = [plant.advance() for _ in range(240)]
        return np.array([[*batch.imu[0].angular_velocity_radps, *plant.truth_pose] for batch in batches])

    np.testing.assert_array_equal(samples(7), samples(7))
    assert not np.array_equal(samples(7), samples(8))


def test_command_reaches_the_motors_after_the_transport_delay():
    plant = KinematicPlant(ROBOT, 1)
    plant.submit(VelocityCommand(0, Twist2(0.5, 0.0)))
    while plant.truth_pose[0] == 0.0:
        plant.advance()
    late_s = plant.stamp_ns / 1e9 - ROBOT.control.transport_delay_s
    assert 0.0 < late_s < (1.0 + 1.0 / SUBSTEPS) / ROBOT.imu.rate_hz


def test_a_command_that_the_base_would_not_take_is_refused():
    plant = KinematicPlant(ROBOT, 1)
    with pytest.raises(CommandRefused, match="future"):
        plant.submit(VelocityCommand(1, Twist2(0.5, 0.0)))
    with pytest.raises(CommandRefused, match="over limit"):
        plant.submit(VelocityCommand(0, Twist2(5.0, 0.0)))


def test_without_commands_the_base_ramps_down():
    plant = KinematicPlant(ROBOT, 1)
    plant.submit(VelocityCommand(0, Twist2(0.5, 0.0)))
    states = [state for _ in range(240) for state in plant.advance().truth]
    assert max(state.twist.speed_mps for state in states) > 0.3
    assert states[-1].twist.speed_mps == pytest.approx(0.0, abs=1e-3)


def driven(ground: Ground, speed_mps: float, yaw_rate_radps: float, seconds=4.0, seed=1):
    """Batches of a plant under a constant command, kept fresh, once the belts have their speeds."""
    plant = KinematicPlant(ROBOT, seed, ground)
    batches = []
    for _ in range(round(ROBOT.imu.rate_hz * seconds)):
        plant.submit(VelocityCommand(plant.stamp_ns, Twist2(speed_mps, yaw_rate_radps)))
        batches.append(plant.advance())
    return batches[ROBOT.imu.rate_hz :]


def slips(batches):
    """Speed and yaw rate slip (n, 2)."""
    return np.array([[slip.speed_mps, slip.yaw_rate_radps] for batch in batches for slip in batch.truth_slip])


def test_ground_without_slip_follows_the_belts():
    assert np.abs(slips(driven(Ground.of_seed(0, severity=0.0), 0.3, 0.8))).max() < 1e-9


def test_severity_scales_the_slip():
    lost = [slips(driven(Ground.of_seed(0, severity=severity), 0.0, 0.8))[:, 1].mean() for severity in (0.5, 1.0, 2.0)]
    assert lost[2] < lost[1] < lost[0] < -0.05


@pytest.mark.parametrize("seed", range(6))
def test_yaw_loss_and_longitudinal_slip_are_those_of_the_law(seed):
    ground = Ground.of_seed(seed)
    on_spot, wide = slips(driven(ground, 0.0, 0.8)), slips(driven(ground, 0.35, 0.3))
    ratio = 0.8 / (0.8 + on_spot[:, 1].mean())
    assert 1.1 < ratio < 1.7
    assert 0.3 / (0.3 + wide[:, 1].mean()) < ratio
    assert 0.01 < -wide[:, 0].mean() / 0.35 < 0.1


def test_the_sensors_see_what_the_body_and_the_belts_do():
    batches = driven(Ground.of_seed(0), 0.2, 0.6)
    gyro = np.mean([batch.imu[0].angular_velocity_radps[2] for batch in batches])
    true = np.mean([state.twist.yaw_rate_radps for batch in batches for state in batch.truth])
    assert gyro == pytest.approx(true, abs=ROBOT.imu.gyro_bias_radps + 0.002)
    tracks = [sample for batch in batches for sample in batch.tracks]
    travelled = tracks[-1].right_travel_m - tracks[0].right_travel_m
    assert travelled == pytest.approx((0.2 + 0.5 * 0.36 * 0.6) * (len(tracks) - 1) / 60, abs=1e-3)
    force = np.mean([batch.imu[0].linear_acceleration_mps2 for batch in batches], axis=0)
    assert force == pytest.approx([0.0, 0.2 * true, 9.81], abs=0.05)


def test_the_obstacle_turns_a_moving_robot_within_its_window_only():
    plain, turned = Ground.of_seed(0), Ground.of_seed(0, obstacle=True, begin_s=1.0)
    assert (plain.yaw_loss, plain.skid_m) == (turned.yaw_loss, turned.skid_m)
    assert turned.kick_s == (2.6, 3.2)
    change = np.abs(slips(driven(turned, 0.3, 0.0))[:, 1] - slips(driven(plain, 0.3, 0.0))[:, 1])
    times = 1.0 + (np.arange(len(change)) + 1) / 60
    inside = (times > 2.6) & (times < 3.2 + 1 / 60)
    assert change[inside].max() > 0.4
    assert change[~inside].max() < 1e-9


@pytest.mark.parametrize("method", ["thesis", "improved"])
def test_double_layer_is_better_than_the_single_one_in_every_column(method):
    assert np.all(rms_errors(method=method) < rms_errors(layers="single", method=method))


def test_improved_lower_layer_is_better_than_the_printed_one(improved):
    printed = rms_errors(method="thesis")
    assert improved[0] < printed[0] and improved[1] < printed[1] and improved[2] < 1.05 * printed[2]


def test_slip_compensation_reduces_the_heading_error(improved):
    assert improved[2] < 0.95 * rms_errors(lower={"slip_compensation": False})[2]


def test_prediction_over_the_latency_helps_the_single_layer():
    plain = rms_errors(layers="single")
    predicted = rms_errors(layers="single", upper={"predict_latency": True})
    assert np.all(predicted < plain)


@pytest.mark.parametrize("layers", ["single", "double"])
@pytest.mark.parametrize("method", ["thesis", "improved"])
def test_goal_pose_is_reached_within_two_centimetres(layers, method):
    for seed in SEEDS[:2]:
        stack = make_stack(layers=layers, method=method, swings=2)
        *_, last = run(seed, stack, duration_s=30.0)
        distance_m, turn_rad = off_goal(stack, last)
        assert distance_m < 0.02 and turn_rad < 0.03
        assert isinstance(stack.steering, NmpcLayers)
        assert stack.steering.upper.approach.phase is Phase.PARKED
        assert last.estimate.odometry.twist == Twist2(0.0, 0.0)


def test_goal_pose_is_reached_after_turning_on_the_spot_across_the_wrap():
    stack = make_stack(shape="stop_and_turn", corners=2, length_m=0.5)
    *_, last = run(SEEDS[0], stack, duration_s=40.0)
    distance_m, turn_rad = off_goal(stack, last)
    assert distance_m < 0.02 and turn_rad < 0.03
