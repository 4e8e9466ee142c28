"""Smoothness of what a person asks for, which never delays a stop."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tracked_description import load_robot
from tracked_safety import ArbiterSettings
from tracked_safety.command_shaper import CommandShaper
from tracked_types import Twist2

SETTINGS = ArbiterSettings.from_robot(load_robot())
LIMITS = SETTINGS.limits
PERIOD_S = 1.0 / 30.0


def shaped(wanted, source="teleop", settings=SETTINGS):
    """What is sent for a sequence of wanted twists, from rest."""
    shaper = CommandShaper(settings, None)
    return [shaper.next(twist, source, index, PERIOD_S) for index, twist in enumerate(wanted)]


def steps(twists, attribute):
    values = [0.0, *(getattr(twist, attribute) for twist in twists)]
    return np.diff(values) / PERIOD_S


@pytest.mark.parametrize(
    ("wanted", "attribute", "most", "jerk"),
    [
        (Twist2(0.5, 0.0), "speed_mps", LIMITS.acceleration_mps2, SETTINGS.jerk_mps3),
        (Twist2(-0.4, 0.0), "speed_mps", LIMITS.acceleration_mps2, SETTINGS.jerk_mps3),
        (Twist2(0.0, 1.3), "yaw_rate_radps", LIMITS.yaw_acceleration_radps2, SETTINGS.yaw_jerk_radps3),
    ],
)
def test_a_person_speeds_up_gently_and_arrives(wanted, attribute, most, jerk):
    sent = shaped([wanted] * 40)
    accelerations = np.abs(steps(sent, attribute))
    assert accelerations.max() <= most * (1.0 + 1e-6)
    assert np.diff([0.0, *accelerations]).max() <= jerk * PERIOD_S * (1.0 + 1e-6)
    assert sent[-1] == wanted and sent[20] == wanted


def test_it_stops_as_fast_as_without_smoothing():
    wanted = [Twist2(0.5, 0.6)] * 40 + [Twist2(0.0, 0.0)] * 15
    plain, smooth = shaped(wanted, "nav"), shaped(wanted)
    assert smooth[39] == plain[39] == wanted[0]
    assert smooth[40:] == plain[40:]


def test_what_plans_its_own_motion_is_not_smoothed():
    wanted = [Twist2(min(0.05 * index, 0.5), 0.0) for index in range(1, 20)]
    assert shaped(wanted, "nav") == wanted
    assert shaped(wanted, "teleop") != wanted


def test_without_a_jerk_limit_only_the_acceleration_counts():
    plain = ArbiterSettings.from_robot(load_robot(), jerk_mps3=0.0, yaw_jerk_radps3=0.0)
    wanted = [Twist2(0.5, 1.0)] * 20
    assert shaped(wanted, settings=plain) == shaped(wanted, "nav")


@given(wanted=st.lists(st.builds(Twist2, st.floats(-0.5, 0.6), st.floats(-1.5, 1.5)), min_size=1, max_size=60))
def test_smoothed_commands_keep_every_limit_and_reach_what_is_wanted_for_long(wanted):
    sent = shaped([*wanted, *[wanted[-1]] * 60])
    assert sent[-1] == LIMITS.clamped(wanted[-1])
    for before, after in pairwise([Twist2(0.0, 0.0), *sent]):
        assert LIMITS.excess(after) <= 1.0 + 1e-9
        assert abs(after.speed_mps - before.speed_mps) <= LIMITS.braking_mps2 * PERIOD_S * (1.0 + 1e-5)


@given(
    current=st.tuples(st.floats(-0.4, 0.5), st.floats(-1.3, 1.3)),
    target=st.tuples(st.floats(-0.4, 0.5), st.floats(-1.3, 1.3)),
    step=st.floats(0.0, 0.3),
)
def test_the_hardest_braking_asks_no_belt_for_more_than_it_can(current, target, step):
    before, after = Twist2(*current), LIMITS.braked(Twist2(*current), Twist2(*target), step)
    change = abs(after.speed_mps - before.speed_mps) + LIMITS.half_gauge_m * abs(
        after.yaw_rate_radps - before.yaw_rate_radps
    )
    assert change <= step * (1.0 + 1e-5) + 1e-12
