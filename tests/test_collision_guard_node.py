"""The collision guard of the command arbiter as others see it: one process, and the tests in the order of this file."""

import math
from array import array

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry as OdometryMessage
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import LaserScan as LaserScanMessage
from std_msgs.msg import Bool
from std_srvs.srv import Trigger
from tracked_interfaces.msg import SafetyState

from node_kit.conversions import command_to_message, odometry_to_message, scan_to_message
from tests.support.domains import own_domain
from tests.support.node_process import NodeProcess
from tests.support.probe import own_probe
from tracked_description import load_robot
from tracked_safety import GuardSettings
from tracked_safety.bench_inputs import BEAMS, odometry, ranges_of, scan
from tracked_types import PeriodGrid, Pose2, Twist2, VelocityCommand

ROBOT = load_robot()
GUARD = GuardSettings.from_robot(ROBOT)
FRONT_M = GUARD.footprint.front_m
CONTROL = PeriodGrid(30)
LATCHED = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
START_LIMIT_S = 60.0
FAST = 0.5
REACTION_S = 0.12


class Drive:
    """A robot that obeys at once, one control period after the other, and looks at posts at ``wall_m`` of odom."""

    def __init__(self, probe, process):
        self.probe, self.process = probe, process
        self.sent = probe.collect(TwistStamped, "cmd_vel", 1000)
        self.states = probe.collect(SafetyState, "safety/state", LATCHED)
        self.diagnostics = probe.collect(DiagnosticArray, "diagnostics", 100)
        create = probe.node.create_publisher
        self.sources = {name: create(TwistStamped, f"cmd_vel_{name}", 10) for name in ("nav", "teleop")}
        self.odom, self.scans = create(OdometryMessage, "odom", 10), create(LaserScanMessage, "scan", 10)
        self.lock = create(Bool, "lock_nav", 10)
        everyone = (*self.sources.values(), self.odom, self.scans, self.lock)
        probe.wait_until(
            lambda: all(p.get_subscription_count() for p in everyone) and probe.node.count_publishers("cmd_vel"),
            timeout_s=START_LIMIT_S,
            what="the arbiter",
        )
        self.x_m, self.wall_m, self.index = 0.0, math.inf, 0
        self.source, self.speed, self.spoil = "nav", FAST, None

    def period(self):
        """One control period; the command that goes out for it."""
        stamp_ns = CONTROL.stamp_ns(self.index)
        speed = self.sent[-1].twist.linear.x if self.sent else 0.0
        self.x_m += speed / 30.0
        if self.index % 3 == 0 and self.index >= 3:
            message = self.scan(CONTROL.stamp_ns(self.index - 3))
            if message is not None:
                self.scans.publish(message)
        pose = Pose2(self.x_m, 0.0, 0.0)
        self.odom.publish(odometry_to_message(odometry(stamp_ns * 1e-9, pose, Twist2(speed, 0.0))))
        count = len(self.sent)
        command = VelocityCommand(stamp_ns, Twist2(self.speed, 0.0))
        self.sources[self.source].publish(command_to_message(command, frame_id="base_footprint"))
        self.probe.wait_until(
            lambda: any(stamp_of(sent) == stamp_ns for sent in self.sent[count:]), what=f"an answer at {self.index}"
        )
        self.index += 1
        return self.sent[-1]

    def unanswered(self, seconds):
        """Control periods whose commands may be held back."""
        for _ in range(round(30 * seconds)):
            stamp_ns = CONTROL.stamp_ns(self.index)
            message = self.scan(CONTROL.stamp_ns(self.index - 3)) if self.index % 3 == 0 else None
            if message is not None:
                self.scans.publish(message)
            self.odom.publish(odometry_to_message(odometry(stamp_ns * 1e-9, Pose2(self.x_m, 0.0, 0.0))))
            command = VelocityCommand(stamp_ns, Twist2(self.speed, 0.0))
            self.sources[self.source].publish(command_to_message(command, frame_id="base_footprint"))
            self.index += 1
            self.probe.spin(0.01)

    def scan(self, began_ns):
        posts = [(self.wall_m - self.x_m, y) for y in np.linspace(-0.3, 0.3, 31)] if math.isfinite(self.wall_m) else []
        message = scan_to_message(scan(began_ns, ranges_of(posts, GUARD.lidar)))
        return message if self.spoil is None else self.spoil(message)

    def run(self, seconds):
        return [self.period() for _ in range(round(30 * seconds))]

    def until(self, condition, what):
        for _ in range(300):
            if condition():
                return
            self.period()
            self.probe.spin(0.01)
        raise AssertionError(f"in vain for {what}; the newest state is {self.states[-1]}")

    def told(self):
        """Keys and messages of the node's own words about its inputs and its guard."""
        statuses = [status for message in self.diagnostics for status in message.status]
        inputs = {
            value.key for status in statuses if status.name == "command_arbiter: inputs" for value in status.values
        }
        guard = [status for status in statuses if status.name == "command_arbiter: collision guard"]
        return inputs, guard


def stamp_of(message):
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    folder = tmp_path_factory.mktemp("guard")
    with own_domain() as domain, own_probe(domain) as probe:
        arguments = ("tracked_safety", "command_arbiter", "--ros-args", "-p", "lock_step:=true")
        process = NodeProcess(arguments, folder / "arbiter.log", {"ROS_DOMAIN_ID": str(domain)})
        try:
            yield Drive(probe, process)
        finally:
            process.end()


def test_the_robot_stands_until_there_is_a_scan_and_then_goes(drive):
    first = drive.run(0.1)
    assert {sent.twist.linear.x for sent in first} == {0.0}
    drive.run(0.6)
    assert drive.sent[-1].twist.linear.x == FAST
    drive.until(lambda: drive.states[-1].guard == SafetyState.GUARD_PASSING, "a free way")


def test_it_reacts_to_what_a_scan_shows_in_time_and_says_why(drive):
    drive.wall_m = drive.x_m + FRONT_M + 0.3
    began = CONTROL.stamp_ns(3 * (-(-drive.index // 3)) - 3)  # of the first scan that shows the wall
    answers = drive.run(3.0)
    slower = next(sent for sent in answers if sent.twist.linear.x < FAST)
    assert 0.0 < (stamp_of(slower) - began) * 1e-9 <= REACTION_S
    assert answers[-1].twist.linear.x == 0.0
    assert 0.0 < drive.wall_m - drive.x_m - FRONT_M < 0.1
    drive.until(lambda: drive.states[-1].guard == SafetyState.GUARD_HOLDING, "the state")
    assert drive.states[-1].guard_reason == "an obstacle is in the way"
    assert any(state.guard == SafetyState.GUARD_SLOWING for state in drive.states)
    assert drive.states[-1].state == SafetyState.FORWARDING and drive.states[-1].source == "nav"
    drive.until(lambda: any(s.level == DiagnosticStatus.WARN for s in drive.told()[1]), "a warning")


def test_a_person_backs_it_off(drive):
    drive.source, drive.speed = "teleop", -0.3
    drive.run(1.0)
    assert drive.sent[-1].twist.linear.x == -0.3
    drive.wall_m, drive.source, drive.speed = math.inf, "nav", FAST
    drive.unanswered(0.3)
    drive.run(1.0)
    assert drive.sent[-1].twist.linear.x == FAST


def spoiled(message, **changes):
    for name, value in changes.items():
        setattr(message, name, value)
    return message


def later(message):
    message.header.stamp.sec += 100
    return message


def elsewhere(message):
    message.header.frame_id = "moon"
    return message


BAD = {
    "too few beams measured anything": lambda m: spoiled(m, ranges=array("f", [math.nan] * BEAMS)),
    "zero: angle_increment": lambda m: spoiled(m, angle_increment=0.0),
    "more than two turns: angle_min": lambda m: spoiled(m, angle_min=1e9, angle_max=1e9),
    "more than two turns: angle_max": lambda m: spoiled(m, angle_max=1e9, angle_increment=1e9 / BEAMS),
    "a revolution of more than 60 s": lambda m: spoiled(m, time_increment=1e9),
    "frame is not laser": elsewhere,
    "stamp in the future": later,
    "not finite: angle_increment": lambda m: spoiled(m, angle_increment=math.nan),
}


def test_bad_scans_are_refused_by_name_and_the_robot_stops(drive):
    kinds = list(BAD.values())
    drive.spoil = lambda message: kinds[drive.index // 3 % len(kinds)](message)
    drive.run(1.0)
    assert drive.sent[-1].twist.linear.x == 0.0
    assert drive.states[-1].guard == SafetyState.GUARD_BLIND
    assert drive.states[-1].guard_reason == "the scan is older than 0.3 s"
    expected = {f"scan: {reason} (from /test_probe)" for reason in BAD}
    drive.until(lambda: expected <= drive.told()[0], "every reason")
    assert drive.process.is_running and "Traceback" not in drive.process.output


def test_a_lidar_that_stays_away_latches_the_stop_until_it_is_released(drive):
    drive.spoil = lambda _message: None
    drive.unanswered(3.0)
    assert drive.states[-1].state == SafetyState.LATCHED_STOP and drive.states[-1].reason == "no scan for 2 s"
    assert not drive.probe.call(Trigger, "release_e_stop").success
    drive.spoil = None
    drive.unanswered(0.2)
    assert drive.sent[-1].twist.linear.x == 0.0
    drive.probe.wait_until(lambda: drive.probe.call(Trigger, "release_e_stop").success, what="the release")
    drive.run(1.0)
    assert drive.sent[-1].twist.linear.x == FAST


def test_a_locked_source_does_not_pass_and_the_e_stop_service_latches(drive):
    drive.lock.publish(Bool(data=True))
    drive.unanswered(1.0)
    drive.probe.wait_until(lambda: drive.states[-1].reason == "nav is locked", what="the lock")
    assert drive.sent[-1].twist.linear.x == 0.0
    drive.lock.publish(Bool(data=False))
    drive.probe.spin(0.1)
    drive.unanswered(0.1)
    drive.run(0.5)
    assert drive.sent[-1].twist.linear.x > 0.3
    assert drive.probe.call(Trigger, "e_stop").success
    drive.unanswered(1.0)
    assert drive.states[-1].state == SafetyState.EMERGENCY_STOP and drive.sent[-1].twist.linear.x == 0.0
    assert drive.probe.call(Trigger, "release_e_stop").success


def test_a_clock_that_jumps_back_stops_it_until_there_is_a_scan_of_the_new_time(drive):
    drive.run(0.7)
    assert drive.sent[-1].twist.linear.x > 0.3
    told = len(drive.states)
    drive.index = 3
    drive.unanswered(1.0)
    drive.run(0.7)
    assert any(state.reason == "clock jumped back" for state in drive.states[told:])
    assert drive.sent[-1].twist.linear.x == FAST
