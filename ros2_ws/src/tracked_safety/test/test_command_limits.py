from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tracked_description import load_robot
from tracked_safety import CommandLimits
from tracked_types import Twist2

LIMITS = replace(CommandLimits.from_robot(load_robot()), track_speed_mps=0.5)
ANY = st.floats(-10.0, 10.0)


def permitted(twist: Twist2) -> bool:
    tolerance = 1.0 + 1e-12
    return (
        LIMITS.speed_min_mps * tolerance <= twist.speed_mps <= LIMITS.speed_max_mps * tolerance
        and abs(twist.yaw_rate_radps) <= LIMITS.yaw_rate_max_radps * tolerance
        and abs(twist.speed_mps) + LIMITS.half_gauge_m * abs(twist.yaw_rate_radps) <= LIMITS.track_speed_mps * tolerance
    )


@given(speed=ANY, yaw_rate=ANY)
def test_a_clamped_twist_is_permitted_and_clamping_it_again_changes_nothing(speed: float, yaw_rate: float) -> None:
    clamped = LIMITS.clamped(Twist2(speed, yaw_rate))
    assert permitted(clamped)
    again = LIMITS.clamped(clamped)
    assert again.speed_mps == pytest.approx(clamped.speed_mps) and again.yaw_rate_radps == pytest.approx(
        clamped.yaw_rate_radps
    )


def test_a_permitted_twist_is_not_touched() -> None:
    twist = Twist2(0.3, -0.7)
    assert LIMITS.clamped(twist) == twist


def test_a_track_that_would_be_too_fast_slows_both_parts_alike() -> None:
    clamped = LIMITS.clamped(Twist2(0.5, 1.0))
    assert clamped.yaw_rate_radps / clamped.speed_mps == pytest.approx(2.0)


@given(a=st.tuples(ANY, ANY), b=st.tuples(ANY, ANY), period=st.floats(0.0, 0.3))
def test_an_approach_stays_permitted_within_its_accelerations(
    a: tuple[float, float], b: tuple[float, float], period: float
) -> None:
    current, target = LIMITS.clamped(Twist2(*a)), LIMITS.clamped(Twist2(*b))
    result = LIMITS.approached(current, target, period)
    assert permitted(result)
    fastest = max(LIMITS.acceleration_mps2, LIMITS.braking_mps2) * period
    assert abs(result.speed_mps - current.speed_mps) <= fastest * (1.0 + 1e-5) + 1e-12
    assert (
        abs(result.yaw_rate_radps - current.yaw_rate_radps)
        <= LIMITS.yaw_acceleration_radps2 * period * (1.0 + 1e-5) + 1e-12
    )


def test_braking_and_accelerating_have_limits_of_their_own() -> None:
    limits = replace(LIMITS, acceleration_mps2=1.0, braking_mps2=2.0)
    assert limits.approached(Twist2(0.2, 0.0), Twist2(0.5, 0.0), 0.1).speed_mps == pytest.approx(0.3)
    assert limits.approached(Twist2(0.4, 0.0), Twist2(0.0, 0.0), 0.1).speed_mps == pytest.approx(0.2)
    assert limits.approached(Twist2(0.4, 0.0), Twist2(-0.4, 0.0), 0.1).speed_mps == pytest.approx(0.2)


def test_a_close_target_is_reached_exactly() -> None:
    target = Twist2(0.31, 0.02)
    assert LIMITS.approached(Twist2(0.3, 0.0), target, 1.0 / 30.0) == target


@pytest.mark.parametrize(
    ("twist", "excess"),
    [(Twist2(0.0, 0.0), 0.0), (Twist2(0.5, 0.0), 1.0), (Twist2(-0.8, 0.0), 2.0), (Twist2(0.1, -3.9), 3.0)],
)
def test_excess_is_the_worst_share_of_a_limit(twist: Twist2, excess: float) -> None:
    assert LIMITS.excess(twist) == pytest.approx(excess)


def test_reversing_is_out_of_the_question_for_a_base_that_cannot() -> None:
    assert replace(LIMITS, speed_min_mps=0.0).excess(Twist2(-0.01, 0.0)) == float("inf")
