"""The plant itself, and both control layers in closed loop on it."""

from collections.abc import Iterator

import numpy as np
import pytest

from nmpc_layers import Phase
from tracked_description import load_robot
from tracked_lab import Reaction, Stack
from tracked_lab.kinematic_plant import Ground, KinematicPlant
from tracked_lab.steering import NmpcLayers
from tracked_lab.tracking import tracking_error
from tracked_types import Twist2, VelocityCommand, angle_difference

ROBOT = load_robot()
SEEDS = (1100, 1101, 1102)


def run(seed, stack: Stack, duration_s=14.0) -> Iterator[Reaction]:
    """Closed loop of stack and plant; what the stack did at each odometry."""
    plant = KinematicPlant(ROBOT, seed)
    for _ in range(round(60 * duration_s)):
        reaction = stack.react(plant.advance().estimate)
        if reaction.sent is not None:
            plant.submit(reaction.sent)
        yield reaction


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
    def poses(seed):
        plant = KinematicPlant(ROBOT, seed)
        plant.submit(VelocityCommand(0, Twist2(0.3, 0.5)))
        return [plant.advance().estimate.odometry.pose for _ in range(120)]

    assert poses(7) == poses(7)
    assert poses(7) != poses(8)


def test_command_reaches_the_motors_after_the_transport_delay():
    plant = KinematicPlant(ROBOT, 1)
    plant.submit(VelocityCommand(0, Twist2(0.5, 0.0)))
    assert [plant.advance().truth.x_m for _ in range(2)] == [0.0, 0.0]
    assert plant.advance().truth.x_m > 0.0


def test_ground_without_slip_follows_the_belts():
    ground = Ground.drawn(np.random.default_rng(0), severity=0.0, obstacle=False)
    plant = KinematicPlant(ROBOT, 1, ground)
    plant.submit(VelocityCommand(0, Twist2(0.3, 0.8)))
    last = [plant.advance() for _ in range(120)][-1]
    assert last.true_slip.yaw_rate_radps == pytest.approx(0.0, abs=1e-9)
    assert last.estimate.slip.yaw_rate_radps == pytest.approx(0.0, abs=0.1)


def test_turning_on_the_spot_loses_yaw_and_the_estimate_sees_it():
    ground = Ground.drawn(np.random.default_rng(0), obstacle=False)
    plant = KinematicPlant(ROBOT, 1, ground)
    plant.submit(VelocityCommand(0, Twist2(0.0, 0.8)))
    samples = [plant.advance() for _ in range(240)][60:]
    assert np.mean([sample.true_slip.yaw_rate_radps for sample in samples]) < -0.1
    errors = [sample.estimate.slip.yaw_rate_radps - sample.true_slip.yaw_rate_radps for sample in samples]
    assert abs(np.mean(errors)) < 0.01


@pytest.mark.parametrize("method", ["thesis", "improved"])
def test_double_layer_is_better_than_the_single_one_in_every_column(method):
    assert np.all(rms_errors(method=method) < rms_errors(layers="single", method=method))


def test_improved_lower_layer_is_better_than_the_printed_one(improved):
    printed = rms_errors(method="thesis")
    assert improved[0] < printed[0] and improved[1] < printed[1] and improved[2] < 1.05 * printed[2]


def test_slip_compensation_reduces_the_heading_error(improved):
    assert improved[2] < 0.9 * rms_errors(lower={"slip_compensation": False})[2]


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
