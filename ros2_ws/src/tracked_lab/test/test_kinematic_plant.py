"""The plant itself, and both control layers in closed loop on it."""

from collections.abc import Iterator

import numpy as np
import pytest

from nmpc_layers import LowerLayer, LowerSettings, Phase, UpperLayer, UpperSettings
from tracked_description import load_robot
from tracked_lab.kinematic_plant import Ground, KinematicPlant, PlantSample
from tracked_navigation import PlayerSettings, ReferenceSettings, TrajectoryPlayer, make_reference
from tracked_navigation.shape_settings import ShapeSettings
from tracked_safety import ArbiterSettings, CommandArbiter
from tracked_types import Trajectory, Twist2, VelocityCommand, angle_difference

ROBOT = load_robot()
SEEDS = (1100, 1101, 1102)


def run(seed, player, upper, lower=None, duration_s=14.0) -> Iterator[tuple[PlantSample, Trajectory]]:
    """Closed loop as the nodes form it: player, layers, arbiter, plant."""
    plant, arbiter = KinematicPlant(ROBOT, seed), CommandArbiter(ArbiterSettings.from_robot(ROBOT))
    reference = Trajectory(0, "odom", np.zeros(1), np.zeros((1, 3)), np.zeros((1, 2)))  # until the first piece
    for _ in range(round(60 * duration_s)):
        sample = plant.advance()
        reference = player.update(sample.odometry).reference or reference
        upper.set_reference(reference)
        planned, command = upper.update(sample.odometry), None
        if planned is not None:
            command = planned.command
            if lower is not None and planned.trajectory is not None:
                lower.set_plan(planned.trajectory)
        if lower is not None:
            lower.set_slip(sample.slip)
            output = lower.update(sample.odometry)
            command = output.command if output is not None else None
        sent = arbiter.offer("nav", command) if command is not None else None
        if sent is not None:
            plant.submit(sent)
            for layer in (upper, lower):
                if layer is not None:
                    layer.set_sent(sent)
        yield sample, reference


def make_player(**shape) -> TrajectoryPlayer:
    reference = make_reference(ROBOT, ReferenceSettings(), ShapeSettings(**shape))
    return TrajectoryPlayer(PlayerSettings(), reference)


def make_layers(layers="double", method="improved", upper=None, lower=None):
    top = UpperLayer(UpperSettings.from_robot(ROBOT, layers=layers, method=method, **(upper or {})))
    if layers == "single":
        return top, None
    return top, LowerLayer(LowerSettings.from_robot(ROBOT, method=method, **(lower or {})))


def rms_errors(seeds=SEEDS, **layers):
    """RMS of estimated minus reference pose over the trajectory, mean over seeds, shape (3,)."""
    results = []
    for seed in seeds:
        player, errors = make_player(swings=2), []
        for sample, reference in run(seed, player, *make_layers(**layers)):
            if player.progress in (0.0, 1.0):
                continue
            states, _ = reference.at(sample.odometry.stamp_ns, np.zeros(1))
            pose = sample.odometry.pose
            turned = angle_difference(pose.yaw_rad, float(states[0, 2]))
            errors.append([pose.x_m - states[0, 0], pose.y_m - states[0, 1], turned])
        results.append(np.sqrt(np.mean(np.square(errors), axis=0)))
    return np.mean(results, axis=0)


@pytest.fixture(scope="module")
def improved():
    return rms_errors()


def test_equal_seeds_and_commands_give_equal_samples():
    def poses(seed):
        plant = KinematicPlant(ROBOT, seed)
        plant.submit(VelocityCommand(0, Twist2(0.3, 0.5)))
        return [plant.advance().odometry.pose for _ in range(120)]

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
    assert last.slip.yaw_rate_radps == pytest.approx(0.0, abs=0.1)


def test_turning_on_the_spot_loses_yaw_and_the_estimate_sees_it():
    ground = Ground.drawn(np.random.default_rng(0), obstacle=False)
    plant = KinematicPlant(ROBOT, 1, ground)
    plant.submit(VelocityCommand(0, Twist2(0.0, 0.8)))
    samples = [plant.advance() for _ in range(240)][60:]
    assert np.mean([sample.true_slip.yaw_rate_radps for sample in samples]) < -0.1
    errors = [sample.slip.yaw_rate_radps - sample.true_slip.yaw_rate_radps for sample in samples]
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
        player = make_player(swings=2)
        upper, lower = make_layers(layers=layers, method=method)
        *_, (last, _) = run(seed, player, upper, lower, duration_s=30.0)
        goal, pose = player.goal, last.odometry.pose
        assert np.hypot(goal.x_m - pose.x_m, goal.y_m - pose.y_m) < 0.02
        assert abs(angle_difference(goal.yaw_rad, pose.yaw_rad)) < 0.03
        assert upper.approach.phase is Phase.PARKED
        assert last.odometry.twist == Twist2(0.0, 0.0)


def test_goal_pose_is_reached_after_turning_on_the_spot_across_the_wrap():
    player = make_player(shape="stop_and_turn", corners=2, length_m=0.5)
    upper, lower = make_layers()
    *_, (last, _) = run(SEEDS[0], player, upper, lower, duration_s=40.0)
    goal, pose = player.goal, last.odometry.pose
    assert np.hypot(goal.x_m - pose.x_m, goal.y_m - pose.y_m) < 0.02
    assert abs(angle_difference(goal.yaw_rad, pose.yaw_rad)) < 0.03
