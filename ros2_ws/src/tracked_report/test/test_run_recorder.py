import numpy as np
import pytest

from tracked_report.channels import CHANNELS
from tracked_report.run_record import RunMeta
from tracked_report.run_recorder import RunRecorder
from tracked_types import (
    BodyState,
    GoalReached,
    Odometry,
    Pose2,
    Slip,
    SolverStatus,
    TrackSample,
    Trajectory,
    Twist2,
    VelocityCommand,
)

META = RunMeta(scenario="test")
TIMES = np.array([0.0, 0.1, 0.2])


def plan(stamp_ns, x_m):
    states = np.column_stack([x_m + TIMES, np.zeros(3), np.zeros(3)])
    return Trajectory(stamp_ns, "odom", TIMES, states, np.column_stack([np.ones(3), np.zeros(3)]))


def body():
    return BodyState(5, np.array([1.0, 2.0, 0.1]), np.array([0.01, 0.02, 0.3]), np.arange(3.0), np.arange(3.0), 9.0)


VALUES = {
    "truth": body(),
    "acceleration": body(),
    "truth_slip": Slip(5, 0.1, 0.2, 0.0, 0.0, True),
    "slip": Slip(5, 0.1, 0.2, 0.01, 0.02, False),
    "odometry": Odometry(5, "odom", "base", Pose2(1.0, 2.0, 0.3), Twist2(0.4, 0.5), np.eye(3), np.eye(2)),
    "tracks": TrackSample(5, 1.0, 2.0, 0.1, 0.2),
    "reference": plan(5, 0.0),
    "upper_plan": plan(5, 0.0),
    "cmd_vel_nav": VelocityCommand(5, Twist2(0.1, 0.2)),
    "cmd_vel": VelocityCommand(5, Twist2(0.1, 0.2)),
    "upper_status": SolverStatus(5, "upper", True, "", 3, 1.0, 1e-4),
    "lower_status": SolverStatus(5, "lower", False, "late", 3, 1.0, 1e-4),
    "goal_reached": GoalReached(5, "line", 0.01, 0.02),
}


@pytest.mark.parametrize("name", CHANNELS)
def test_every_channel_of_the_table_takes_its_type(name):
    recorder = RunRecorder()
    recorder.add(name, VALUES[name], arrival_s=2.5)
    channel = recorder.record(META).channel(name)
    assert channel.columns == CHANNELS[name].columns
    assert channel.stamps_ns[0] == 5
    assert channel.arrivals_s[0] == 2.5


def test_the_newest_reference_replaces_what_earlier_ones_said_of_the_same_time():
    recorder = RunRecorder()
    recorder.add("reference", plan(0, 0.0))
    recorder.add("reference", plan(100_000_000, 5.0))
    reference = recorder.record(META).channel("reference")
    assert reference.column("x_m").tolist() == pytest.approx([0.0, 5.0, 5.1, 5.2])
    assert np.all(np.diff(reference.stamps_ns) > 0)


def test_plans_of_the_upper_layer_leave_their_first_point_each():
    recorder = RunRecorder()
    recorder.add("upper_plan", plan(0, 0.0))
    recorder.add("upper_plan", plan(100_000_000, 5.0))
    assert recorder.record(META).channel("upper_plan").column("x_m").tolist() == [0.0, 5.0]


def test_channels_outside_the_table_name_their_columns():
    recorder = RunRecorder()
    recorder.add_row("memory", 7, (1.0,), columns=("used_mb",))
    assert recorder.record(META).channel("memory").column("used_mb").tolist() == [1.0]
    with pytest.raises(KeyError, match="name its columns"):
        recorder.add_row("speed", 7, (1.0,))
    with pytest.raises(KeyError, match="no channel 'speed'"):
        recorder.add("speed", VALUES["slip"])


def test_a_row_of_the_wrong_length_is_refused():
    with pytest.raises(ValueError, match="expected speed_mps, yaw_rate_radps; got 3 numbers"):
        RunRecorder().add_row("cmd_vel", 1, (1.0, 2.0, 3.0))


def test_a_record_taken_early_does_not_grow_later():
    recorder = RunRecorder()
    recorder.add("cmd_vel", VALUES["cmd_vel"])
    early = recorder.record(META)
    recorder.add("cmd_vel", VALUES["cmd_vel"])
    recorder.add_event(9, "simulator", "fault")
    assert (len(early.channel("cmd_vel")), early.events) == (1, ())
