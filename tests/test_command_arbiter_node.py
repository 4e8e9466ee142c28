"""The command arbiter as others see it: who passes, what stops the robot, and what is left when it is told to end."""

import signal

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry as OdometryMessage
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Bool
from std_srvs.srv import Trigger
from tracked_interfaces.msg import SafetyState

from node_kit.conversions import command_to_message, odometry_to_message
from tracked_types import Odometry, PeriodGrid, Pose2, Twist2, VelocityCommand

NODE = ("tracked_safety", "command_arbiter")
CONTROL = PeriodGrid(30)
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
START_LIMIT_S = 60.0


class Arbiter:
    """The node under test and everything around it."""

    def __init__(self, probe, start_node, *arguments, output=TwistStamped):
        self.probe = probe
        self.sent = probe.collect(output, "cmd_vel", 1000)
        self.states = probe.collect(SafetyState, "safety/state", LATCHED)
        self.process = start_node(*NODE, "--ros-args", "-p", "collision_guard:=false", *arguments)
        self.sources = {
            name: probe.node.create_publisher(TwistStamped, f"cmd_vel_{name}", 10) for name in ("nav", "teleop")
        }
        self.odom = probe.node.create_publisher(OdometryMessage, "odom", 10)
        self.e_stop = probe.node.create_publisher(Bool, "e_stop", LATCHED)
        everyone = (*self.sources.values(), self.odom, self.e_stop)
        probe.wait_until(
            lambda: (
                all(publisher.get_subscription_count() for publisher in everyone)
                and probe.node.count_publishers("cmd_vel")
            ),
            timeout_s=START_LIMIT_S,
            what="the arbiter",
        )
        probe.wait_until(lambda: self.states, what="its state")

    def command(self, source, index, speed, yaw_rate=0.0):
        made = VelocityCommand(CONTROL.stamp_ns(index), Twist2(speed, yaw_rate))
        self.sources[source].publish(command_to_message(made))

    def tick(self, index):
        pose, twist = Pose2(0.0, 0.0, 0.0), Twist2(0.0, 0.0)
        made = Odometry(CONTROL.stamp_ns(index), "odom", "base_footprint", pose, twist, np.eye(3), np.eye(2))
        self.odom.publish(odometry_to_message(made))

    def answer(self, source, index, speed):
        """Send a command and wait for the one that goes out for it; ramps to zero may still come in between."""
        count = len(self.sent)
        self.command(source, index, speed)

        def answers():
            fresh = self.sent[count:]
            return [sent for sent in fresh if isinstance(sent, Twist) or stamp_ns(sent) == CONTROL.stamp_ns(index)]

        self.probe.wait_until(answers, what=f"an answer to {source}")
        return answers()[-1]

    def drive(self, first, last, speed=0.3):
        """Odometry and commands, in step."""
        for index in range(first, last):
            self.tick(index)
            self.answer("nav", index, speed)

    def state(self):
        return self.states[-1].state


def stamp_ns(message):
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def test_commands_pass_with_their_stamps_and_silence_ramps_to_zero(probe, start_node):
    arbiter = Arbiter(probe, start_node, "-p", "lock_step:=true")
    arbiter.drive(0, 30)
    assert [stamp_ns(message) for message in arbiter.sent] == [CONTROL.stamp_ns(index) for index in range(30)]
    assert arbiter.sent[-1].twist.linear.x == 0.3
    assert probe.node.count_publishers("cmd_vel") == 1
    for index in range(30, 60):
        arbiter.tick(index)
        due = 30 + max(0, index - 35)  # the last command is from 29, six control periods are 0.2 s
        probe.wait_until(lambda due=due: len(arbiter.sent) == due, what="the ramp and then zero")
    speeds = [message.twist.linear.x for message in arbiter.sent[29:]]
    assert speeds == sorted(speeds, reverse=True) and speeds[-1] == 0.0 and 0.0 < speeds[2] < 0.3
    probe.wait_until(lambda: arbiter.state() == SafetyState.STOPPED, what="the state")
    assert arbiter.states[-1].reason == "nav silent for 0.2 s"
    assert stamp_ns(arbiter.answer("nav", 60, 0.1)) == CONTROL.stamp_ns(60)
    probe.wait_until(lambda: arbiter.state() == SafetyState.FORWARDING, what="the state")


def test_teleop_goes_before_navigation_and_nonsense_does_not_go_at_all(probe, start_node):
    arbiter = Arbiter(probe, start_node, "-p", "lock_step:=true")
    arbiter.drive(0, 3)
    assert arbiter.answer("teleop", 3, 0.0).twist.linear.x < 0.3
    count = len(arbiter.sent)
    for speed in (float("nan"), float("inf"), 50.0):
        arbiter.command("teleop", 4, speed)
    arbiter.command("nav", 4, 0.3)
    assert stamp_ns(arbiter.answer("teleop", 5, 0.0)) == CONTROL.stamp_ns(5)
    assert len(arbiter.sent) == count + 1


def test_a_refused_command_is_reported_with_its_reason_and_sender(probe, start_node):
    diagnostics = probe.collect(DiagnosticArray, "diagnostics")
    arbiter = Arbiter(probe, start_node, "-p", "lock_step:=true")
    words = "cmd_vel_teleop (beyond 1.5 times a limit, from /test_probe)"

    def told():
        arbiter.command("teleop", 4, 50.0)
        statuses = [status for message in diagnostics for status in message.status]
        return any(words in status.message for status in statuses if status.name == "command_arbiter: inputs")

    probe.wait_until(told, what="a warning")
    probe.wait_until(lambda: "rejected cmd_vel_teleop from" in arbiter.process.output, what="a log line")


def test_emergency_stop_latches_until_released_by_service(probe, start_node):
    arbiter = Arbiter(probe, start_node, "-p", "lock_step:=true")
    arbiter.drive(0, 10)
    arbiter.e_stop.publish(Bool(data=True))
    probe.wait_until(lambda: arbiter.state() == SafetyState.EMERGENCY_STOP, what="the emergency stop")
    for index in range(10, 30):
        arbiter.tick(index)
        arbiter.command("nav", index, 0.3)
    probe.wait_until(lambda: arbiter.sent[-1].twist.linear.x == 0.0, what="zero")
    refused = probe.call(Trigger, "release_e_stop")
    assert not refused.success and "still pressed" in refused.message
    arbiter.e_stop.publish(Bool(data=False))
    probe.wait_until(lambda: probe.call(Trigger, "release_e_stop").success, what="the release")
    assert arbiter.answer("nav", 31, 0.3).twist.linear.x > 0.0


def test_without_odometry_the_wall_clock_stops_the_robot(probe, start_node):
    arbiter = Arbiter(probe, start_node)
    for index in range(10):
        arbiter.answer("nav", index, 0.3)
    probe.wait_until(lambda: arbiter.sent[-1].twist.linear.x == 0.0, what="zero")
    assert stamp_ns(arbiter.sent[-1]) == CONTROL.stamp_ns(9)
    assert arbiter.states[-1].reason == "nav and the odometry silent"


def test_a_termination_leaves_the_robot_at_zero(probe, start_node):
    arbiter = Arbiter(probe, start_node, "-p", "lock_step:=true")
    arbiter.drive(0, 20)
    count = len(arbiter.sent)
    assert arbiter.process.stop(signal.SIGTERM) == 0
    probe.wait_until(lambda: arbiter.sent[-1].twist.linear.x == 0.0, what="zero")
    ramp = [message.twist.linear.x for message in arbiter.sent[count - 1 :]]
    assert ramp == sorted(ramp, reverse=True) and len(ramp) >= 6


def test_a_base_may_get_plain_twists(probe, start_node):
    stamped = probe.collect(TwistStamped, "cmd_vel_stamped")
    arbiter = Arbiter(probe, start_node, "-p", "lock_step:=true", "-p", "plain_twist:=true", output=Twist)
    assert arbiter.answer("nav", 0, 0.02).linear.x == 0.02
    probe.wait_until(lambda: stamped, what="the stamped copy")
