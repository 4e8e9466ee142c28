"""Teleoperation as its user sees it: keys in a real terminal, and messages of a joystick."""

import os
import pty
import signal
import termios
from array import array

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TwistStamped
from sensor_msgs.msg import Joy

from tests.support.domains import own_domain
from tests.support.malformed import malformed
from tests.support.node_process import NodeProcess
from tests.support.probe import own_probe

START_LIMIT_S = 60.0
REPEAT_S = 0.03


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    """Both nodes, the outer end of the keyboard's terminal, and what they command."""
    folder = tmp_path_factory.mktemp("teleop")
    outside, inside = pty.openpty()
    before = termios.tcgetattr(inside)
    with own_domain() as domain, own_probe(domain) as probe:
        environment = {"ROS_DOMAIN_ID": str(domain)}
        keyboard = NodeProcess(
            ("tracked_safety", "teleop_keyboard", "--ros-args", "-r", "cmd_vel_teleop:=by_key"),
            folder / "keys.log",
            environment,
            inside,
        )
        joystick = NodeProcess(
            ("tracked_safety", "teleop_joy", "--ros-args", "-r", "cmd_vel_teleop:=by_stick"),
            folder / "joy.log",
            environment,
        )
        try:
            by_key, by_stick = (probe.collect(TwistStamped, name, 100) for name in ("by_key", "by_stick"))
            sticks = probe.node.create_publisher(Joy, "joy", 10)
            probe.wait_until(
                lambda: (
                    sticks.get_subscription_count()
                    and all(probe.node.count_publishers(name) for name in ("by_key", "by_stick"))
                    and "Ctrl-C ends" in keyboard.output
                ),
                timeout_s=START_LIMIT_S,
                what="both nodes",
            )
            yield probe, keyboard, joystick, outside, (inside, before), by_key, by_stick, sticks
        finally:
            keyboard.end()
            joystick.end()
            os.close(outside)
            os.close(inside)


def hold(probe, outside, keys, condition):
    """What a terminal sends while a key is held down, until it has an effect."""
    for _ in range(300):
        os.write(outside, keys)
        probe.spin(REPEAT_S)
        if condition():
            return
    raise AssertionError(f"{keys!r} had no effect")


def stamp_ns(message):
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def test_nothing_is_commanded_before_a_key_is_pressed(both):
    probe, *_, by_key, by_stick, _ = both
    probe.spin(0.3)
    assert by_key == [] and by_stick == []


def test_a_held_key_drives_and_its_release_stops_and_then_leaves_the_way_to_others(both):
    probe, _, _, outside, _, by_key, *_ = both
    hold(probe, outside, b"\x1b[A", lambda: sum(sent.twist.linear.x == 0.25 for sent in by_key) > 10)
    assert {sent.header.frame_id for sent in by_key} == {"base_footprint"}
    probe.wait_until(lambda: by_key[-1].twist.linear.x == 0.0, what="the stop")
    probe.spin(0.8)
    count = len(by_key)
    probe.spin(0.3)
    assert len(by_key) == count, "it has fallen silent"
    stamps = [stamp_ns(sent) for sent in by_key]
    assert stamps == sorted(set(stamps))


def test_space_stops_and_keeps_others_from_driving(both):
    probe, keyboard, _, outside, _, by_key, *_ = both
    os.write(outside, b"++")
    hold(probe, outside, b"d", lambda: by_key[-1].twist.angular.z == pytest.approx(-0.6 * 1.21))
    os.write(outside, b" ")
    probe.wait_until(lambda: by_key[-1].twist.angular.z == 0.0, what="the stop")
    count = len(by_key)
    probe.wait_until(lambda: len(by_key) > count + 30, what="a stop that is kept up")
    assert "0.30 m/s, 0.73 rad/s" in keyboard.output


def test_the_terminal_gets_back_its_manners_when_the_node_ends(both):
    _, keyboard, _, _, (inside, before), *_ = both
    assert termios.tcgetattr(inside) != before
    assert keyboard.stop(signal.SIGINT) == 0
    assert termios.tcgetattr(inside) == before


def test_without_a_terminal_it_says_so_in_one_line(tmp_path):
    with own_domain() as domain:
        process = NodeProcess(("tracked_safety", "teleop_keyboard"), tmp_path / "log", {"ROS_DOMAIN_ID": str(domain)})
        assert process.wait(START_LIMIT_S) == 1
    assert "standard input is no terminal" in process.output and "Traceback" not in process.output


def stick(probe, linear=0.0, button=True):
    message = Joy(axes=array("f", [0.0, linear]), buttons=array("i", [0, 0, 0, 0, int(button), 0]))
    message.header.stamp = probe.node.get_clock().now().to_msg()
    return message


def push(probe, sticks, by_stick):
    """What a driver sends while a stick is pushed ahead, until it has an effect."""
    for _ in range(100):
        sticks.publish(stick(probe, 1.0))
        probe.spin(0.05)
        if by_stick and by_stick[-1].twist.linear.x == 0.25:
            return
    raise AssertionError("the stick had no effect")


def test_a_stick_drives_while_its_button_is_down(both):
    probe, *_, by_stick, sticks = both
    push(probe, sticks, by_stick)
    sticks.publish(stick(probe, 1.0, button=False))
    probe.wait_until(lambda: by_stick[-1].twist.linear.x == 0.0, what="the stop")
    push(probe, sticks, by_stick)
    probe.wait_until(lambda: by_stick[-1].twist.linear.x == 0.0, what="the stop after silence")


def test_messages_of_a_joystick_that_make_no_sense_are_refused_by_name(both):
    probe, _, joystick, *_, by_stick, sticks = both
    probe.spin(0.8)
    count, told = len(by_stick), probe.collect(DiagnosticArray, "diagnostics", 100)
    late, few, buttonless = stick(probe, 1.0), stick(probe, 1.0), stick(probe, 1.0)
    late.header.stamp.sec -= 10
    few.axes, buttonless.buttons = array("f", [1.0]), array("i", [1])
    for message in (late, few, buttonless, *malformed(stick(probe, 0.0, button=False))):
        sticks.publish(message)
        probe.spin(0.005)
    expected = {
        f"joy: {reason} (from /test_probe)"
        for reason in (
            "stale stamp",
            "1 axes, there is no axis 1",
            "1 buttons, there is no button 5",
            "not finite: axes",
        )
    }
    probe.wait_until(
        lambda: expected <= {value.key for message in told for status in message.status for value in status.values},
        what=f"{expected}",
    )
    assert all(sent.twist.linear.x == 0.0 for sent in by_stick[count:])
    assert joystick.stop(signal.SIGTERM) == 0 and "Traceback" not in joystick.output
