"""Nodes of one graph in one process: parameters, checked inputs, diagnostics, services, transforms."""

import math
from dataclasses import dataclass

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TwistStamped
from rcl_interfaces.msg import ParameterType
from rclpy.node import Node
from rclpy.parameter import Parameter as RosParameter
from sensor_msgs.msg import Imu
from std_srvs.srv import Trigger

from node_kit import (
    BadParameterError,
    Level,
    Parameter,
    ParameterTable,
    RejectedMessage,
    StackNode,
    qos,
)
from node_kit.conversions import (
    command_from_message,
    command_to_message,
    imu_from_message,
    imu_to_message,
)
from tracked_types import Twist2, VelocityCommand
from tracked_types.setting import check_settings, setting


@dataclass(frozen=True, slots=True, kw_only=True)
class EchoSettings:
    gain: float = setting(1.0, "Gain of the echo", unit="1/s", low=0.0, high=5.0)
    mode: str = setting("soft", "How it stops", choices=("soft", "hard"))

    def __post_init__(self) -> None:
        check_settings(self)


class EchoNode(StackNode):
    """Answers an IMU sample with a command."""

    NAME = "echo"
    PARAMETERS = ParameterTable.from_settings(EchoSettings, live=("gain",))

    def __init__(self, **options) -> None:
        super().__init__(**options)
        self.settings = EchoSettings(**self.tuning(EchoSettings))
        self.heard = []
        self.fault = None
        self.commands = self.publish_typed(TwistStamped, "cmd_vel", command_to_message, qos.COMMAND)
        self.subscribe_typed(Imu, "imu/data", imu_from_message, self.on_imu, qos.SENSOR)
        self.serve(Trigger, "reset", self.on_reset)

    def parameters_changed(self, changed) -> None:
        self.settings = EchoSettings(**self.tuning(EchoSettings))

    def on_imu(self, sample) -> None:
        if self.fault is not None:
            raise self.fault
        self.heard.append(sample)
        speed = self.settings.gain * float(sample.linear_acceleration_mps2[0])
        self.commands.publish(VelocityCommand(sample.stamp_ns, Twist2(speed, 0.0)))

    def on_reset(self, request, response):
        raise RejectedMessage("nothing to reset")


class StrictNode(EchoNode):
    """Accepts one frame only."""

    NAME = "strict"

    def __init__(self, **options) -> None:
        super().__init__(**options)
        self.subscribe_typed(
            Imu, "imu/strict", imu_from_message, self.on_imu, qos.SENSOR, expected_frame=self.frame("imu_link")
        )


@pytest.fixture
def imu_message(families):
    return imu_to_message(families["imu"][0])


@pytest.fixture
def source(graph):
    """A plain node that sends IMU messages, once it has met its reader."""
    node = graph.plain("imu_driver")
    publisher = node.create_publisher(Imu, "imu/data", qos.SENSOR)

    def send(message):
        graph.spin_until(lambda: publisher.get_subscription_count() > 0, "a reader of imu/data")
        publisher.publish(message)

    return send


def test_value_in_value_out(graph, source, imu_message):
    echo = graph.add(EchoNode, "-p", "gain:=2")
    commands = []
    graph.plain("base").create_subscription(TwistStamped, "cmd_vel", commands.append, 10)
    graph.spin_until(lambda: echo.commands.publisher.get_subscription_count(), "the base")
    imu_message.linear_acceleration.x = 0.25
    source(imu_message)
    graph.spin_until(lambda: commands, "a command")
    command = command_from_message(commands[0])
    assert command == VelocityCommand(echo.heard[0].stamp_ns, Twist2(0.5, 0.0))


def test_malformed_messages_are_counted_with_reason_and_sender(graph, source, imu_message):
    echo = graph.add(EchoNode)
    newest = graph.statuses()
    imu_message.angular_velocity.y = math.nan
    for _ in range(3):
        source(imu_message)
    key = "imu/data: not finite: angular_velocity.y (from /imu_driver)"
    status = graph.spin_until(
        lambda: (
            (found := newest.get("echo: inputs"))
            and any(v.key == key and v.value == "3" for v in found.values)
            and found
        ),
        "three counted rejections",
    )
    assert status.level == bytes([Level.WARN])
    assert status.message == "rejected: imu/data (not finite: angular_velocity.y, from /imu_driver)"
    assert echo.heard == []


def test_diagnostics_tell_how_many_publishers_each_input_hears(graph):
    graph.add(EchoNode)
    newest = graph.statuses()

    def heard():
        status = newest.get("echo: connections")
        return {value.key: value.value for value in status.values} if status else None

    graph.spin_until(lambda: heard() == {"imu/data": "0"}, "a report of silence")
    graph.plain("imu_driver").create_publisher(Imu, "imu/data", qos.SENSOR)
    graph.spin_until(lambda: heard() == {"imu/data": "1"}, "a report of the driver")


def test_wrong_frame_is_rejected_where_one_is_expected(graph, imu_message):
    strict = graph.add(StrictNode, "-p", "frame_prefix:=robot1/")
    newest = graph.statuses()
    publisher = graph.plain("imu_driver").create_publisher(Imu, "imu/strict", qos.SENSOR)
    graph.spin_until(publisher.get_subscription_count, "a reader")
    publisher.publish(imu_message)
    graph.spin_until(lambda: "strict: inputs" in newest, "a report")
    assert "frame is not robot1/imu_link" in newest["strict: inputs"].message
    imu_message.header.frame_id = "robot1/imu_link"
    publisher.publish(imu_message)
    graph.spin_until(lambda: strict.heard, "an accepted message")


def test_failing_callback_is_reported_and_the_next_message_served(graph, source, imu_message):
    echo = graph.add(EchoNode)
    newest = graph.statuses()
    echo.fault = ZeroDivisionError("no way")
    source(imu_message)
    graph.spin_until(lambda: "echo: callbacks" in newest, "a report of the failure")
    assert newest["echo: callbacks"].level == bytes([Level.ERROR])
    assert newest["echo: callbacks"].message == "EchoNode.on_imu failed: ZeroDivisionError: no way"
    assert echo.exit_code is None
    echo.fault = None
    source(imu_message)
    graph.spin_until(lambda: echo.heard, "the next message")


def test_callback_may_reject_a_value_itself(graph, source, imu_message):
    echo = graph.add(EchoNode)
    newest = graph.statuses()
    echo.fault = RejectedMessage("stamp goes back")
    source(imu_message)
    graph.spin_until(lambda: "echo: inputs" in newest, "a report")
    assert "stamp goes back, from /imu_driver" in newest["echo: inputs"].message
    assert {value.key: value.value for value in newest["echo: inputs"].values}["imu/data: accepted"] == "0"


def test_refused_service_request_is_answered(graph):
    graph.add(EchoNode)
    client = graph.plain("user").create_client(Trigger, "reset")
    graph.spin_until(client.service_is_ready, "the service")
    future = client.call_async(Trigger.Request())
    graph.spin_until(future.done, "the answer")
    assert (future.result().success, future.result().message) == (False, "nothing to reset")


def test_diagnostics_appear_every_second_with_hardware_id(graph):
    echo = graph.add(EchoNode, "-r", "__ns:=/robot1")
    seen = []
    graph.plain("monitor").create_subscription(DiagnosticArray, "/robot1/diagnostics", seen.append, 10)
    graph.spin_until(lambda: len(seen) >= 2, "two reports")
    assert {status.hardware_id for message in seen for status in message.status} == {"robot1"}
    assert "echo: inputs" in {status.name for message in seen for status in message.status}
    assert echo.diagnostics.hardware_id == "robot1"


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("-p", "gain:=7.0"), "gain must be at most 5 1/s, got 7.0"),
        (("-p", "gain:=.nan"), "gain must be finite"),
        (("-p", "gain:=fast"), "gain must be of type float, got 'fast'"),
        (("-p", "mode:=rigid", "-p", "gain:=-1.0"), "gain .*; parameter mode must be one of soft, hard"),
        (("-p", "frame_prefix:=/robot 1"), "frame_prefix is no frame name"),
        (("-p", f"frame_prefix:={'a' * 100}!"), "frame_prefix is no frame name"),
    ],
)
def test_bad_parameter_stops_the_start_with_its_name(graph, arguments, reason):
    with pytest.raises(BadParameterError, match=reason):
        graph.add(EchoNode, *arguments)


def test_unknown_parameter_is_a_warning_and_no_reason_to_stop(graph):
    newest = graph.statuses()
    assert graph.add(EchoNode, "-p", "gian:=2.0").value("gain") == 1.0
    graph.spin_until(lambda: "echo: parameters" in newest, "a warning")
    assert newest["echo: parameters"].message == "parameter gian is unknown (did you mean gain?); ignored"


def test_live_parameter_follows_and_is_checked_others_are_read_only(graph):
    echo = graph.add(EchoNode)

    def set_parameter(name, value):
        return echo.set_parameters([RosParameter(name, value=value)])[0]

    assert set_parameter("gain", 3).successful
    assert echo.settings.gain == 3.0
    refused = set_parameter("gain", 9.0)
    assert not refused.successful
    assert "gain" in refused.reason
    assert echo.settings.gain == 3.0
    assert "read-only" in set_parameter("mode", "hard").reason


def test_descriptors_tell_tools_range_choices_and_unit(graph):
    echo = graph.add(EchoNode)
    gain, mode = echo.describe_parameters(["gain", "mode"])
    assert gain.type == ParameterType.PARAMETER_DOUBLE
    assert (gain.floating_point_range[0].from_value, gain.floating_point_range[0].to_value) == (0.0, 5.0)
    assert gain.description == "Gain of the echo [1/s]"
    assert not gain.read_only
    assert mode.read_only
    assert mode.additional_constraints == "one of soft, hard"


def test_integer_and_one_sided_ranges_reach_the_descriptor(graph):
    class Counter(StackNode):
        NAME = "counter"
        PARAMETERS = ParameterTable(Parameter("count", 3, "Tries", low=1), Parameter("speed", 1.0, "Speed", high=2.0))

    count, speed = graph.add(Counter).describe_parameters(["count", "speed"])
    assert count.integer_range[0].from_value == 1
    assert speed.floating_point_range[0].to_value == 2.0
    assert speed.floating_point_range[0].from_value < -1e300


def test_simulated_time_parameter_can_be_read_and_is_not_unknown(graph):
    assert graph.add(EchoNode, "-p", "use_sim_time:=true").value("use_sim_time") is True


def test_base_class_hides_nothing_of_a_ros_node(graph):
    own = {name for name in vars(StackNode) if not name.startswith("__")}
    assert own & set(dir(Node)) == set()
    assert not {"exit_code", "typed_publishers", "diagnostics", "_table_values", "_monitor", "_failures"} & set(
        dir(Node)
    )
