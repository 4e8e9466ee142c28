"""The simulator node as others see it: streams, commands, time and services."""

import math

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, JointState, LaserScan
from tracked_interfaces.msg import Result, SlipEstimate
from tracked_interfaces.srv import (
    DeleteEntity,
    GetEntities,
    GetEntityState,
    GetSimulationState,
    GetSimulatorFeatures,
    InjectFault,
    ResetSimulation,
    SetEntityState,
    SetFriction,
    SetSimulationState,
    SetSuspension,
    SpawnEntity,
    StepSimulation,
)

from tracked_description import load_robot
from tracked_types import PeriodGrid

NODE = ("sim_bridge", "sim_bridge", "--ros-args", "--log-level", "warn")
ROBOT = load_robot()
PAUSED, PLAYING = SetSimulationState.Request.PAUSED, SetSimulationState.Request.PLAYING
QUEUE = 1000
# Where nothing is compiled yet, or everything else runs at the same time.
START_LIMIT_S = 60.0


def parameters(**values):
    return [argument for name, value in values.items() for argument in ("-p", f"{name}:={value}")]


def running(probe, start_node, **values):
    """The node, started with these parameters, when its time runs; and the clock's messages."""
    clock = probe.collect(Clock, "clock", QUEUE)
    node = start_node(*NODE, *parameters(**values))
    probe.wait_until(lambda: clock, timeout_s=START_LIMIT_S, what="the clock")
    return node, clock


def stamp_ns(message):
    stamp = message.clock if isinstance(message, Clock) else message.header.stamp
    return stamp.sec * 10**9 + stamp.nanosec


def command(stamp, speed=0.0, yaw_rate=0.0):
    message = TwistStamped()
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, 10**9)
    message.twist.linear.x, message.twist.angular.z = float(speed), float(yaw_rate)
    return message


def test_every_stream_has_its_rate_its_frame_and_exact_stamps(probe, start_node):
    imu = probe.collect(Imu, "imu/data", QUEUE)
    joints, scans = probe.collect(JointState, "joint_states", QUEUE), probe.collect(LaserScan, "scan", QUEUE)
    truth = probe.collect(Odometry, "ground_truth/odom", QUEUE)
    slip = probe.collect(SlipEstimate, "ground_truth/slip", QUEUE)
    _, clock = running(probe, start_node, world="rooms", frame_prefix="robot1/")
    probe.wait_until(lambda: len(scans) >= 6, what="six scans")
    for messages, rate_hz in ((clock, 60), (imu, 120), (joints, 60), (scans, 10), (truth, 60), (slip, 60)):
        stamps = [stamp_ns(message) for message in messages]
        grid = PeriodGrid(rate_hz)
        assert stamps == [grid.stamp_ns(grid.index_at(stamps[0]) + k) for k in range(len(stamps))]
    assert imu[0].header.frame_id == "robot1/imu_link"
    assert scans[0].header.frame_id == "robot1/laser"
    assert (truth[0].header.frame_id, truth[0].child_frame_id) == ("robot1/world", "robot1/base_footprint")
    assert imu[0].orientation_covariance[0] == -1.0
    assert joints[0].name[:3] == ["left_track", "right_track", "left_suspension_1"]
    assert len(scans[0].ranges) == ROBOT.lidar.beams


def test_commands_drive_it_and_silence_stops_it(probe, start_node):
    running(probe, start_node)
    truth = probe.collect(Odometry, "ground_truth/odom", QUEUE)
    publisher = probe.publisher(TwistStamped, "cmd_vel")
    answered = []

    def fast():
        if truth and stamp_ns(truth[-1]) not in answered:
            answered.append(stamp_ns(truth[-1]))
            publisher.publish(command(answered[-1], 0.4))
        return truth and truth[-1].twist.twist.linear.x > 0.35

    probe.wait_until(fast, what="the robot at speed")
    silent_since = answered[-1]
    probe.wait_until(lambda: abs(truth[-1].twist.twist.linear.x) < 0.02, what="the robot at rest")
    assert stamp_ns(truth[-1]) - silent_since < 1_000_000_000


def test_plain_twists_drive_a_robot_in_a_namespace(probe, start_node):
    truth = probe.collect(Odometry, "/robot1/ground_truth/odom", QUEUE)
    start_node(*NODE, "-r", "__ns:=/robot1", *parameters(stamped_commands="false"))
    publisher = probe.node.create_publisher(Twist, "/robot1/cmd_vel", QUEUE)
    twist = Twist()
    twist.angular.z = 0.8

    def turning():
        publisher.publish(twist)
        return truth and truth[-1].twist.twist.angular.z > 0.5

    probe.wait_until(turning, timeout_s=START_LIMIT_S, what="the robot turning")


def test_bad_commands_are_refused_and_told_with_their_sender(probe, start_node):
    running(probe, start_node)
    diagnostics = probe.collect(DiagnosticArray, "diagnostics", QUEUE)
    truth = probe.collect(Odometry, "ground_truth/odom", QUEUE)
    publisher = probe.publisher(TwistStamped, "cmd_vel")
    # Later than the timeout, so that a stamp of zero is stale.
    probe.wait_until(lambda: truth and stamp_ns(truth[-1]) > 500_000_000, what="half a second")

    def reasons():
        newest = stamp_ns(truth[-1])
        for bad in (command(newest, math.nan), command(newest, 7.0), command(newest + 10**12, 0.3), command(0, 0.3)):
            publisher.publish(bad)
        return {value.key for message in diagnostics for status in message.status for value in status.values}

    expected = ("not finite: linear.x", "speed over limit", "stamped in the future", "stale")
    probe.wait_until(
        lambda: (told := reasons()) and all(f"cmd_vel: {reason} (from /test_probe)" in told for reason in expected),
        what="all four reasons",
    )
    assert abs(truth[-1].pose.pose.position.x) < 1e-3


class Commander:
    """Answers the 30 Hz instants of joint_states from ``begin_ns`` to ``end_ns``: first rest, then a curve."""

    def __init__(self, probe, begin_ns, end_ns):
        self.publisher = probe.node.create_publisher(TwistStamped, "cmd_vel", QUEUE)
        self.begin_ns, self.end_ns, self.newest_ns = begin_ns, end_ns, 0
        probe.node.create_subscription(JointState, "joint_states", self.answer, QUEUE)

    def answer(self, message):
        stamp = stamp_ns(message)
        if self.begin_ns <= stamp <= self.end_ns and PeriodGrid(30).is_instant(stamp):
            self.newest_ns = stamp
            moving = stamp > self.begin_ns + 200_000_000
            self.publisher.publish(command(stamp, 0.3 if moving else 0.0, 0.5 if moving else 0.0))


def lock_stepped(probe, start_node):
    """IMU samples by stamp of a lock-step run that ends with its commands; and how it ended."""
    imu = probe.collect(Imu, "imu/data", QUEUE)
    commander = Commander(probe, 1_000_000_000, 4_000_000_000)
    node, _ = running(probe, start_node, time_mode="lock_step", first_command_s=1.0, lock_step_limit_s=1.0, seed=3)
    probe.wait_until(lambda: not node.is_running, timeout_s=START_LIMIT_S, what="the end of the lock")
    return {stamp_ns(message): numbers(message) for message in imu}, commander, node


def numbers(message):
    rate, force = message.angular_velocity, message.linear_acceleration
    return (rate.x, rate.y, rate.z, force.x, force.y, force.z)


def test_lock_step_waits_for_commands_gives_up_with_a_reason_and_repeats_itself_exactly(probe, start_node):
    first, commander, node = lock_stepped(probe, start_node)
    assert node.wait() == 1
    assert "lock-step: no command for" in node.output
    assert max(first) <= commander.newest_ns + 50_001_000
    second, _, _ = lock_stepped(probe, start_node)
    common = first.keys() & second.keys()
    assert len(common) > 300
    assert {stamp: first[stamp] for stamp in common} == {stamp: second[stamp] for stamp in common}


def test_time_can_be_paused_stepped_and_never_goes_back(probe, start_node):
    _, clock = running(probe, start_node)
    assert probe.call(StepSimulation, "step_simulation", StepSimulation.Request(steps=4)).result.result == (
        Result.INCORRECT_STATE
    )
    probe.call(SetSimulationState, "set_simulation_state", SetSimulationState.Request(state=PAUSED))
    assert probe.call(GetSimulationState, "get_simulation_state").state == PAUSED
    truth = probe.collect(Odometry, "ground_truth/odom", QUEUE)
    assert probe.call(StepSimulation, "step_simulation", StepSimulation.Request(steps=80)).result.result == Result.OK
    probe.wait_until(lambda: len(truth) == 10, what="a sixth of a second")
    assert probe.call(ResetSimulation, "reset_simulation", ResetSimulation.Request(seed=4)).result.result == Result.OK
    probe.call(SetSimulationState, "set_simulation_state", SetSimulationState.Request(state=PLAYING))
    before = len(clock)
    probe.wait_until(lambda: len(clock) > before + 5, what="time to run on")
    stamps = [stamp_ns(message) for message in clock]
    assert stamps == sorted(set(stamps))
    assert probe.call(SetSimulationState, "set_simulation_state").result.result == Result.OPERATION_FAILED


def test_bodies_and_surfaces_can_be_changed(probe, start_node):
    running(probe, start_node, world="ice")
    features = probe.call(GetSimulatorFeatures, "get_simulator_features").features
    assert {"spawn_entity", "inject_fault", "time_mode lock_step"} <= set(features)
    spawn = SpawnEntity.Request()
    spawn.entity.name, spawn.entity.shape, spawn.entity.mass = "crate", "box", 2.0
    spawn.entity.size[:] = (0.3, 0.3, 0.3)
    spawn.initial_pose.position.x, spawn.initial_pose.position.z = 2.0, 0.15
    assert probe.call(SpawnEntity, "spawn_entity", spawn).result.result == Result.OK
    assert probe.call(SpawnEntity, "spawn_entity", spawn).result.result == Result.OPERATION_FAILED
    assert set(probe.call(GetEntities, "get_entities").entities) >= {ROBOT.name, "crate"}
    move = SetEntityState.Request(entity=ROBOT.name)
    move.state.pose.position.x, move.state.pose.position.y = -1.0, 0.5
    assert probe.call(SetEntityState, "set_entity_state", move).result.result == Result.OK
    state = probe.call(GetEntityState, "get_entity_state", GetEntityState.Request(entity=ROBOT.name)).state
    assert (state.pose.position.x, state.pose.position.y) == pytest.approx((-1.0, 0.5), abs=1e-3)
    move.state.pose.position.x = math.nan
    assert probe.call(SetEntityState, "set_entity_state", move).result.result == Result.OPERATION_FAILED
    assert probe.call(DeleteEntity, "delete_entity", DeleteEntity.Request(entity="crate")).result.result == Result.OK
    gone = probe.call(DeleteEntity, "delete_entity", DeleteEntity.Request(entity="crate")).result
    assert gone.result == Result.NOT_FOUND
    assert ROBOT.name in gone.error_message
    friction = SetFriction.Request(zone="", friction_longitudinal=0.5, friction_lateral=0.4)
    assert probe.call(SetFriction, "set_friction", friction).result.result == Result.OK
    assert probe.call(SetSuspension, "set_suspension", SetSuspension.Request(kind="locked")).result.result == Result.OK
    assert (
        probe.call(SetSuspension, "set_suspension", SetSuspension.Request(kind="x")).result.result == Result.NOT_FOUND
    )


def test_injected_faults_show_in_the_stream_and_on_diagnostics(probe, start_node):
    running(probe, start_node)
    diagnostics = probe.collect(DiagnosticArray, "diagnostics", QUEUE)
    imu = probe.collect(Imu, "imu/data", QUEUE)
    request = InjectFault.Request(sensor="imu", kind="nan")
    assert probe.call(InjectFault, "inject_fault", request).result.result == Result.OK
    probe.wait_until(lambda: imu and math.isnan(imu[-1].angular_velocity.z), what="NaN from the IMU")
    probe.wait_until(lambda: any("imu nan" in str(message) for message in diagnostics), what="the fault told")
    assert probe.call(InjectFault, "inject_fault", InjectFault.Request(sensor="imu")).result.result == Result.OK
    probe.wait_until(lambda: math.isfinite(imu[-1].angular_velocity.z), what="a healthy IMU")
    refused = probe.call(InjectFault, "inject_fault", InjectFault.Request(sensor="nose", kind="nan")).result
    assert refused.result == Result.OPERATION_FAILED
    assert "tracks, imu, scan" in refused.error_message


@pytest.mark.parametrize(
    ("bad", "code", "told"),
    [
        ({"world": "atlantis"}, 1, "rooms"),
        ({"time_mode": "warp", "physics_rate_hz": -3, "seed": -1}, 2, "lock_step"),
    ],
)
def test_a_bad_parameter_is_one_clear_line(start_node, bad, code, told):
    node = start_node(*NODE, *parameters(**bad))
    assert node.wait() == code
    assert told in node.output
    assert all(name in node.output for name in bad)
    assert "Traceback" not in node.output
