"""Both control layers as others see them: what they publish when, and what they wait for."""

import math

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry as OdometryMessage
from tracked_interfaces.msg import SlipEstimate, SolverStatus
from tracked_interfaces.msg import Trajectory as TrajectoryMessage

from node_kit.conversions import odometry_to_message, slip_to_message, trajectory_to_message
from tracked_types import Odometry, PeriodGrid, Pose2, Slip, Trajectory, Twist2

UPPER, LOWER = ("nmpc_layers", "upper_nmpc"), ("nmpc_layers", "lower_nmpc")
GRID = PeriodGrid(60)
START_LIMIT_S = 60.0
"""Where no solver is compiled yet, or everything else runs at the same time."""


def parameters(**values):
    return ("--ros-args", *(argument for name, value in values.items() for argument in ("-p", f"{name}:={value}")))


def odometry(index, x=0.0):
    pose, twist = Pose2(x, 0.0, 0.0), Twist2(0.3, 0.0)
    made = Odometry(GRID.stamp_ns(index), "odom", "base_footprint", pose, twist, np.eye(3) * 1e-4, np.eye(2) * 1e-4)
    return odometry_to_message(made)


def slip(index):
    return slip_to_message(Slip(GRID.stamp_ns(index), 0.0, 0.0, 1e-4, 1e-4, known=True), frame_id="base_footprint")


def straight(index, speed=0.3):
    times = np.arange(0.0, 3.01, 0.05)
    states = np.column_stack([speed * times, np.zeros_like(times), np.zeros_like(times)])
    inputs = np.column_stack([np.full_like(times, speed), np.zeros_like(times)])
    return trajectory_to_message(Trajectory(GRID.stamp_ns(index), "odom", times, states, inputs))


def stamp_ns(message):
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def running(probe, start_node, node, **values):
    """The node, started with these parameters, when it has met the publisher of its odometry."""
    process = start_node(*node, *parameters(**values))
    publisher = probe.node.create_publisher(OdometryMessage, "odom", 100)
    probe.wait_until(publisher.get_subscription_count, timeout_s=START_LIMIT_S, what=f"{node[1]} at odom")
    return process, publisher


def test_upper_layer_stamps_its_plans_with_the_odometry_they_were_made_from(probe, start_node):
    _, odom = running(probe, start_node, UPPER, pipeline_latency_s=0.1)
    reference = probe.publisher(TrajectoryMessage, "reference_trajectory")
    plans = probe.collect(TrajectoryMessage, "upper_nmpc/trajectory", 100)
    status = probe.collect(SolverStatus, "upper_nmpc/status", 100)
    indices = iter(range(12, 10_000))

    def planned():
        index = next(indices)
        reference.publish(straight(index))
        odom.publish(odometry(index))
        return plans and any(message.ok for message in status)

    probe.wait_until(planned, what="a plan")
    assert all(PeriodGrid(5).is_instant(stamp_ns(message)) for message in (*plans, *status))


def test_single_layer_commands_the_base_itself(probe, start_node):
    _, odom = running(probe, start_node, UPPER, layers="single", pipeline_latency_s=0.0)
    reference = probe.publisher(TrajectoryMessage, "reference_trajectory")
    commands = probe.collect(TwistStamped, "cmd_vel_nav", 100)
    reference.publish(straight(12))
    probe.wait_until(lambda: probe.node.count_publishers("cmd_vel_nav"), what="its commands")
    index = iter(range(12, 10_000))

    def commanded():
        odom.publish(odometry(next(index)))
        return commands

    probe.wait_until(commanded, what="a command")
    assert commands[0].header.frame_id == "base_footprint"


def test_lower_layer_in_lock_step_waits_for_slip_and_plan(probe, start_node):
    _, odom = running(probe, start_node, LOWER, lock_step="true", pipeline_latency_s=0.1)
    plan, slips = probe.publisher(TrajectoryMessage, "upper_nmpc/trajectory"), probe.publisher(SlipEstimate, "slip")
    commands = probe.collect(TwistStamped, "cmd_vel_nav", 100)
    # In the place of the arbiter: all passes.
    sent = probe.publisher(TwistStamped, "cmd_vel")
    probe.node.create_subscription(TwistStamped, "cmd_vel_nav", sent.publish, 100)
    indices = iter(range(12, 10_000))

    def feed(index):
        odom.publish(odometry(index))
        slips.publish(slip(index))

    def commanded():
        index = next(indices)
        if index % 12 == 0:
            plan.publish(straight(index))
        feed(index)
        return commands

    probe.wait_until(commanded, what="a first command")
    due = next(index for index in indices if index % 12 == 0)
    for index in range(due, due + 7):
        feed(index)
    probe.wait_until(lambda: stamp_ns(commands[-1]) == GRID.stamp_ns(due + 4), what="the commands before")
    before = GRID.stamp_ns(due + 4)
    probe.wait_until(lambda: stamp_ns(commands[-1]) == before, what="the last command of the plan before")
    # Due with the odometry six periods later, which has already been sent; it asks for the opposite direction.
    plan.publish(straight(due, speed=-0.3))
    last = GRID.stamp_ns(due + 6)
    probe.wait_until(lambda: stamp_ns(commands[-1]) == last, what="the command that waited")
    by_stamp = {stamp_ns(message): message.twist.linear.x for message in commands}
    assert by_stamp[last] < by_stamp[before] - 0.1


def test_malformed_inputs_are_refused_and_told(probe, start_node):
    process, odom = running(probe, start_node, LOWER)
    plan = probe.publisher(TrajectoryMessage, "upper_nmpc/trajectory")
    diagnostics = probe.collect(DiagnosticArray, "diagnostics", 100)
    spoiled, ragged = straight(12), straight(12)
    spoiled.x[3] = math.nan
    ragged.yaw = ragged.yaw[:-1]

    def reasons():
        for message in (spoiled, ragged):
            plan.publish(message)
        odom.publish(odometry(12, x=math.inf))
        return [value.key for message in diagnostics for task in message.status for value in task.values]

    def told():
        seen = " ".join(reasons())
        return "upper_nmpc/trajectory" in seen and "odom" in seen

    probe.wait_until(told, what="both offenders")
    assert process.is_running


def test_a_plan_of_another_robot_is_refused(probe, start_node):
    _, odom = running(probe, start_node, LOWER, frame_prefix="r1/")
    plan = probe.publisher(TrajectoryMessage, "upper_nmpc/trajectory")
    commands = probe.collect(TwistStamped, "cmd_vel_nav", 100)
    diagnostics = probe.collect(DiagnosticArray, "diagnostics", 100)
    indices = iter(range(12, 10_000))

    def fed(frame):
        index = next(indices)
        for message, publisher in ((straight(index), plan), (odometry(index), odom)):
            message.header.frame_id = frame
            publisher.publish(message)

    def told():
        fed("r2/odom")
        seen = " ".join(value.key for message in diagnostics for task in message.status for value in task.values)
        return all(f"{topic}: frame is not r1/odom" in seen for topic in ("odom", "upper_nmpc/trajectory"))

    probe.wait_until(told, what="both refusals")
    assert not commands
    probe.wait_until(lambda: fed("r1/odom") or commands, what="a command for a plan of its own")


@pytest.mark.parametrize(
    ("node", "name", "value"),
    [
        (UPPER, "method", "printed"),
        (UPPER, "weights_file", "/no/such/weights.yaml"),
        (UPPER, "rate_hz", "10"),  # for which there is no certified terminal weight
        (LOWER, "plan_timeout_s", "0.1"),
    ],
)
def test_a_bad_parameter_is_named_in_one_line(start_node, node, name, value):
    process = start_node(*node, *parameters(**{name: value}))
    assert process.wait() != 0
    assert (value if name == "weights_file" else name) in process.output
    assert "Traceback" not in process.output
