import numpy as np
import pytest

from tracked_description import load_robot
from tracked_lab.conditions import Conditions
from tracked_lab.lock_step import drive
from tracked_lab.peers import PEERS
from tracked_lab.steering_registry import make_steering
from tracked_lab.tuning import UnknownParameterError
from tracked_report.metrics import run_metrics
from tracked_report.scenario import Scenario
from tracked_types import Odometry, Pose2, Slip, Trajectory, Twist2

ROBOT = load_robot()
SHARED = {"pipeline_latency_s": 0.1, "plan_rate_hz": 5, "seed": 1}
FRAME = (ROBOT.frames.odom, ROBOT.frames.base_footprint)


def scenario(seed=2000, **options):
    return Scenario.model_validate(
        {"name": "t", "world": "flat", "seed": seed, "duration_s": 6.0, "reference": {"shape": "s_curve"}} | options
    )


def odometry(stamp_ns, pose=Pose2(0.0, 0.0, 0.0)):  # noqa: B008 - a Pose2 cannot change
    return Odometry(stamp_ns, *FRAME, pose, Twist2(0.0, 0.0), np.eye(3) * 1e-4, np.eye(2) * 1e-4)


def straight(stamp_ns, speed=0.3):
    times = np.arange(0.0, 3.01, 0.05)
    states = np.column_stack([speed * times, np.zeros((len(times), 2))])
    return Trajectory(stamp_ns, ROBOT.frames.odom, times, states, np.tile([speed, 0.0], (len(times), 1)))


@pytest.mark.parametrize("name", [name for name in PEERS if name not in ("opti", "do_mpc")])
def test_every_peer_follows_the_curve_of_a_slipping_robot(name):
    record = drive(scenario(), "double", conditions=Conditions(plant="kinematic", pose="lidar", steering=name))
    values = run_metrics(record).values
    assert values["true.rms_distance_m"] < 0.08 and values["true.rms_theta_rad"] < 0.2
    assert values["command.violations"] == 0.0


def test_the_usual_solvers_drive_as_the_layer_that_they_stand_for():
    conditions = Conditions(plant="kinematic", steering="opti")
    single = scenario(duration_s=3.0, variants={"single": {"layers": "single"}})
    peer = drive(scenario(duration_s=3.0), "double", conditions=conditions)
    own = drive(single, "single", conditions=Conditions(plant="kinematic"))
    assert peer.channel("truth").values == pytest.approx(own.channel("truth").values, abs=1e-3)


@pytest.mark.parametrize("name", PEERS)
def test_a_parameter_that_a_peer_does_not_have_is_refused_by_name(name):
    with pytest.raises(UnknownParameterError, match="charm"):
        make_steering(name, ROBOT, {**SHARED, "charm": 1.0})


@pytest.mark.parametrize(
    ("name", "own"),
    [("pure_pursuit", {"lookahead_s": 0.0}), ("mppi", {"samples": 0}), ("constant_multiplier", {"factor": 99.0})],
)
def test_a_parameter_out_of_range_is_refused(name, own):
    with pytest.raises(ValueError, match=next(iter(own))):
        make_steering(name, ROBOT, {**SHARED, **own})


@pytest.mark.parametrize("name", ["pure_pursuit", "regulated_pure_pursuit", "mppi"])
def test_without_a_reference_a_controller_stands_and_says_so(name):
    peer = make_steering(name, ROBOT, SHARED)
    peer.set_slip(Slip(0, 0.0, 0.0, 0.0, 0.0, known=False))
    outputs = [peer.update(odometry(index * 16_666_667)) for index in range(1, 9)]
    commands = [output.command.twist for output in outputs if output is not None]
    assert len(commands) == 4 and set(commands) == {Twist2(0.0, 0.0)}
    assert all("no reference" in output.status.reason for output in outputs if output is not None)


@pytest.mark.parametrize("name", ["pure_pursuit", "regulated_pure_pursuit", "mppi"])
def test_a_reference_counts_only_once_it_is_out_of_the_pipeline(name):
    peer = make_steering(name, ROBOT, SHARED)
    peer.set_reference(straight(0))
    early = peer.update(odometry(66_666_667))
    late = peer.update(odometry(133_333_333))
    assert early.command.twist == Twist2(0.0, 0.0) and late.command.twist.speed_mps > 0.0


def test_pursuit_turns_towards_a_path_on_its_left():
    peer = make_steering("pure_pursuit", ROBOT, {**SHARED, "pipeline_latency_s": 0.0})
    peer.set_reference(straight(33_333_333))
    assert peer.update(odometry(33_333_333, Pose2(0.0, -0.2, 0.0))).command.twist.yaw_rate_radps > 0.1


def test_equal_seeds_make_equal_mppi_runs():
    records = [
        drive(scenario(duration_s=2.0), "double", conditions=Conditions(plant="kinematic", steering="mppi"))
        for _ in range(2)
    ]
    assert np.array_equal(records[0].channel("cmd_vel").values, records[1].channel("cmd_vel").values)
