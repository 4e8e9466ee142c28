"""What keys and joysticks ask for, and what is asked when they fall silent."""

import os
import pty
import termios
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tracked_description import load_robot
from tracked_safety import CommandLimits
from tracked_safety.teleop.joy_teleop import JoySettings, JoystickRefused, JoyTeleop
from tracked_safety.teleop.key_decoder import KeyDecoder
from tracked_safety.teleop.key_teleop import MOTIONS, KeySettings, KeyTeleop
from tracked_safety.teleop.raw_terminal import NoTerminalError, RawTerminal
from tracked_types import Joystick, Twist2, to_nanoseconds

ROBOT = load_robot()
KEYS, JOY = KeySettings.from_robot(ROBOT), JoySettings.from_robot(ROBOT)
LIMITS = CommandLimits.from_robot(ROBOT)
REST = Twist2(0.0, 0.0)


def test_a_key_drives_while_it_is_repeated_and_rest_follows_within_a_fifth_of_a_second():
    teleop = KeyTeleop(KEYS)
    for index in range(10):
        teleop.press("up", 0.03 * index)
        assert teleop.twist(0.03 * index + 0.02) == Twist2(KEYS.speed_mps, 0.0)
    assert teleop.twist(0.27 + 0.2 - 1 / 30) == REST
    assert teleop.twist(0.27 + KEYS.hold_s + KEYS.rest_s - 0.01) == REST
    assert teleop.twist(0.27 + KEYS.hold_s + KEYS.rest_s) is None


def test_a_first_press_counts_longer_only_if_it_is_set_so():
    assert KeyTeleop(KEYS).twist(0.0) is None
    for first, later in ((KEYS, REST), (replace(KEYS, first_hold_s=0.6), Twist2(0.25, 0.0))):
        teleop = KeyTeleop(first)
        teleop.press("w", 0.0)
        assert teleop.twist(0.4) == later
        teleop.press("w", 0.5)
        teleop.press("w", 0.53)
    assert teleop.twist(0.53 + KEYS.hold_s) == REST


@pytest.mark.parametrize("key", [" ", "k", "q", "unknown", "1"])
def test_space_and_every_key_without_a_meaning_stop_and_keep_others_from_driving(key):
    teleop = KeyTeleop(KEYS)
    teleop.press("w", 0.0)
    teleop.press(key, 0.05)
    assert teleop.twist(0.06) == REST and teleop.twist(1e6) == REST
    teleop.press("s", 1e6)
    assert teleop.twist(1e6) == Twist2(-KEYS.speed_mps, 0.0)


@pytest.mark.parametrize(
    ("key", "signs"), [("a", (0, 1)), ("right", (0, -1)), ("u", (1, 1)), (",", (-1, 0)), ("m", (-1, -1))]
)
def test_keys_go_where_they_say(key, signs):
    teleop = KeyTeleop(KEYS)
    teleop.press(key, 0.0)
    twist = teleop.twist(0.0)
    assert twist == Twist2(signs[0] * KEYS.speed_mps, signs[1] * KEYS.yaw_rate_radps)


def test_speed_keys_change_speeds_up_to_the_limits_and_move_nothing():
    teleop = KeyTeleop(KEYS)
    teleop.press("+", 0.0)
    teleop.press("[", 0.0)
    assert teleop.speeds == Twist2(pytest.approx(0.275), pytest.approx(0.6)) and teleop.twist(0.0) is None
    for _ in range(100):
        teleop.press("=", 0.0)
    assert teleop.speeds == Twist2(LIMITS.speed_max_mps, LIMITS.yaw_rate_max_radps)
    teleop.press("-", 0.0)
    teleop.press("]", 0.0)
    assert teleop.speeds.speed_mps < LIMITS.speed_max_mps


@given(presses=st.lists(st.tuples(st.sampled_from([*MOTIONS, "+", "-", "[", "]", " ", "x"]), st.floats(0.0, 0.5))))
def test_whatever_is_typed_is_permitted_and_ends_in_time(presses):
    teleop, now_s = KeyTeleop(KEYS), 0.0
    for key, pause_s in presses:
        now_s += pause_s
        teleop.press(key, now_s)
        twist = teleop.twist(now_s)
        assert twist is None or LIMITS.clamped(twist) == twist
        assert teleop.twist(now_s + 0.2) in (REST, None)


@pytest.mark.parametrize(
    ("chunks", "keys"),
    [
        ([b"w"], ["w"]),
        ([b"W"], ["w"]),
        ([b"\x1b[A\x1b[B\x1bOC\x1b[D"], ["up", "down", "right", "left"]),
        ([b"\x1b", b"[", b"A"], ["up"]),
        ([b"\x1b", b""], ["unknown"]),
        ([b"\x1b[", b"", b"A"], ["unknown", "a"]),
        ([b"\x1b[Z", b"\x1bx"], ["unknown", "unknown", "x"]),
        ([b"\x00\xff\n"], ["unknown"] * 3),
    ],
)
def test_what_a_terminal_sends_becomes_keys(chunks, keys):
    decoder = KeyDecoder()
    assert [key for chunk in chunks for key in decoder.feed(chunk)] == keys


@given(chunks=st.lists(st.binary(max_size=20)))
def test_no_bytes_upset_the_decoder(chunks):
    decoder = KeyDecoder()
    for chunk in chunks:
        assert all(key in ("up", "down", "left", "right", "unknown") or len(key) == 1 for key in decoder.feed(chunk))
    decoder.feed(b"")
    assert decoder.feed(b"w") == ["w"]


def test_a_terminal_gives_single_keys_and_gets_back_its_manners():
    outside, inside = pty.openpty()
    before = termios.tcgetattr(inside)
    terminal = RawTerminal(inside)
    assert terminal.read() == b""
    os.write(outside, b"wa")
    assert terminal.read() == b"wa"
    assert not termios.tcgetattr(inside)[3] & (termios.ECHO | termios.ICANON)
    assert termios.tcgetattr(inside)[3] & termios.ISIG, "Ctrl-C still ends"
    terminal.restore()
    assert termios.tcgetattr(inside) == before
    os.close(outside)
    with pytest.raises(NoTerminalError, match="gone"):
        terminal.read()
    os.close(inside)


def test_what_is_no_terminal_is_refused():
    reading, writing = os.pipe()
    with pytest.raises(NoTerminalError, match="no terminal"):
        RawTerminal(reading)
    os.close(reading), os.close(writing)


def stick(time_s=1.0, linear=1.0, angular=0.0, pressed=(4,), axes=2, buttons=6):
    values = (angular, linear, *[0.0] * 8)[:axes]
    return Joystick(to_nanoseconds(time_s), values, tuple(index in pressed for index in range(buttons)))


def asked(joystick, settings=JOY):
    teleop = JoyTeleop(settings)
    teleop.update(joystick, to_nanoseconds(1.0), 0.0)
    return teleop.twist(0.0)


def test_a_stick_drives_only_while_the_dead_mans_button_is_down():
    assert asked(stick()) == Twist2(JOY.scale_linear_mps, 0.0)
    assert asked(stick(pressed=())) is None
    assert asked(stick(linear=-1.0, angular=1.0)) == Twist2(-JOY.scale_linear_mps, JOY.scale_angular_radps)
    assert asked(stick(pressed=(5,))) == Twist2(JOY.turbo_linear_mps, 0.0)
    assert asked(stick(), replace(JOY, scale_linear_mps=-0.2)) == Twist2(-0.2, 0.0)
    assert asked(stick(linear=0.04)) == REST
    assert asked(stick(linear=0.525)).speed_mps == pytest.approx(0.5 * JOY.scale_linear_mps)


def test_a_fast_setting_is_cut_to_the_limits():
    twist = asked(stick(angular=1.0), replace(JOY, scale_linear_mps=5.0, scale_angular_radps=9.0))
    assert LIMITS.excess(twist) <= 1.0


def test_release_and_silence_stop_within_a_fifth_of_a_second():
    teleop = JoyTeleop(JOY)
    teleop.update(stick(1.0), to_nanoseconds(1.0), 0.0)
    teleop.update(stick(1.05, pressed=()), to_nanoseconds(1.05), 0.05)
    assert teleop.twist(0.05) == REST and teleop.twist(0.05 + JOY.rest_s) is None
    teleop.update(stick(3.0), to_nanoseconds(3.0), 2.0)
    assert teleop.twist(2.0 + 0.2 - 1 / 30) == REST


@pytest.mark.parametrize(
    ("message", "reason"),
    [
        (stick(axes=1), "1 axes, there is no axis 1"),
        (stick(axes=0), "0 axes, there is no axis 1"),
        (stick(buttons=5), "5 buttons, there is no button 5"),
        (stick(0.7), "stale stamp"),
        (stick(0.0), "stale stamp"),
        (stick(1.3), "stamp in the future"),
        (stick(1.0), "stamp repeated or out of order"),
        (stick(0.95), "stamp repeated or out of order"),
    ],
)
def test_a_message_that_cannot_be_used_is_refused_with_its_reason_and_keeps_nothing_up(message, reason):
    teleop = JoyTeleop(JOY)
    teleop.update(stick(1.0), to_nanoseconds(1.0), 0.0)
    with pytest.raises(JoystickRefused) as refused:
        teleop.update(message, to_nanoseconds(1.0), 0.1)
    assert refused.value.reason == reason
    assert teleop.twist(0.16) == REST


@pytest.mark.parametrize("wrong", [{"axis_linear": -1}, {"hold_s": 1.0}, {"enable_turbo_button": -2}])
def test_settings_that_make_no_sense_are_named(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        JoySettings.from_robot(ROBOT, **wrong)
