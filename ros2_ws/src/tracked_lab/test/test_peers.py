import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tracked_description import load_robot
from tracked_lab.campaign.run_inputs import hash_of
from tracked_lab.campaign.spec import load_spec
from tracked_lab.conditions import Conditions
from tracked_lab.lock_step import drive
from tracked_lab.peers import PEERS
from tracked_lab.peers.path_integral import as_seen_from, roll_out
from tracked_lab.steering_registry import make_steering
from tracked_lab.table_variants import TABLE_VARIANTS, packaged_weights
from tracked_lab.tuning import UnknownParameterError
from tracked_report.metrics import run_metrics
from tracked_report.scenario import Scenario
from tracked_types import Odometry, Pose2, Slip, Trajectory, Twist2, wrap_angle

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
    single = scenario(
        duration_s=3.0, variants={"single": TABLE_VARIANTS["single"].with_weights(packaged_weights("single"))}
    )
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


def test_runs_of_peers_change_with_the_weights_that_they_have():
    spec = load_spec("peers")
    hashes = {run.way: run.weights for run in spec.runs()}
    assert hashes["opti"] == hashes["do_mpc"] == hash_of(packaged_weights("single"))
    assert hashes["constant_multiplier"] == hashes["double_improved"] and not hashes["mppi"]


def test_a_run_that_was_planned_with_other_weights_is_refused():
    planned = next(run for run in load_spec("peers").runs() if run.way == "opti")
    with pytest.raises(ValueError, match=r"single\.yaml have changed"):
        planned.model_copy(update={"weights": "0" * 12}).record()


def test_mppi_keeps_the_limits_of_speed_and_its_change():
    record = drive(scenario(duration_s=4.0), "double", conditions=Conditions(plant="kinematic", steering="mppi"))
    asked = record.channel("cmd_vel_nav")
    speeds, rates = asked.column("speed_mps"), asked.column("yaw_rate_radps")
    assert speeds.max() <= ROBOT.limits.speed_max_mps and np.abs(rates).max() <= ROBOT.limits.yaw_rate_max_radps


def test_path_integral_costs_are_least_for_the_copy_that_is_not_disturbed_where_the_plan_is_right():
    plan = np.tile([0.3, 0.2], (20, 1))
    headings = 0.2 / 30.0 * np.arange(1, 21)
    middles = headings - 0.1 / 30.0
    places = 0.01 * np.cumsum(np.column_stack([np.cos(middles), np.sin(middles)]), axis=0)
    noise = np.random.default_rng(0).normal(0.0, 0.1, (50, 20, 2))
    noise[7] = 0.0
    costs = np.empty(50)
    limits = (np.array([-0.4, -1.3]), np.array([0.5, 1.3]), np.array([0.05, 0.2]))
    critics = np.array([14.0, 2.0, 4.0, 5.0, 5.0, 0.0])
    reference = np.column_stack([places, headings])
    roll_out(plan, noise, reference, plan[0], limits, 1.0 / 30.0, critics, np.zeros(2), costs)
    assert costs.argmin() == 7 and costs[7] == pytest.approx(0.0, abs=1e-9)


@given(yaw=st.floats(-3.1, 3.1), turn=st.floats(-3.0, 3.0))
def test_headings_seen_from_the_robot_do_not_jump(yaw, turn):
    headings = wrap_angle(yaw + np.linspace(0.0, turn, 30))
    seen = as_seen_from(Pose2(1.0, 2.0, yaw), np.column_stack([np.ones(30), np.full(30, 2.0), headings]))
    np.testing.assert_allclose(seen[:, 2], np.linspace(0.0, turn, 30), atol=1e-9)
    np.testing.assert_allclose(seen[:, :2], 0.0, atol=1e-12)
