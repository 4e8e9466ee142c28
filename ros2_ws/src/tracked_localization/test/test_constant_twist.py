import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from tracked_localization.constant_twist import constant_twist_step

SPEEDS = st.floats(-1.0, 1.0)
RATES = st.floats(-3.0, 3.0)
YAWS = st.floats(-math.pi, math.pi)


@pytest.mark.parametrize("steps", [1, 2, 3, 7, 60])
def test_circle_closes_however_coarse_the_steps_are(steps):
    x = y = yaw = 0.0
    for _ in range(steps):
        step = constant_twist_step(yaw, 0.4, 2.0 * math.pi / 5.0, 5.0 / steps)
        x, y, yaw = x + step.x_m, y + step.y_m, yaw + step.yaw_rad
    assert (x, y) == pytest.approx((0.0, 0.0), abs=1e-12)
    assert yaw == pytest.approx(2.0 * math.pi)


@given(YAWS, SPEEDS, RATES, st.floats(0.001, 2.0))
def test_two_half_steps_are_one_step(yaw, speed, rate, duration):
    whole = constant_twist_step(yaw, speed, rate, duration)
    first = constant_twist_step(yaw, speed, rate, duration / 2.0)
    second = constant_twist_step(yaw + first.yaw_rad, speed, rate, duration / 2.0)
    assert whole.x_m == pytest.approx(first.x_m + second.x_m, abs=1e-9)
    assert whole.y_m == pytest.approx(first.y_m + second.y_m, abs=1e-9)


def test_slide_turns_the_motion_off_the_heading_and_keeps_the_forward_speed():
    step = constant_twist_step(0.0, 0.4, 1.0, 1e-6, slide_s=0.2)
    assert step.x_m == pytest.approx(0.4e-6)
    assert step.y_m == pytest.approx(-0.4e-6 * math.tan(0.2), rel=1e-5)


@given(YAWS, SPEEDS, RATES, st.floats(0.001, 0.5), st.floats(0.0, 0.5))
def test_derivatives_are_those_of_the_displacement(yaw, speed, rate, duration, slide):
    assume(abs(abs(slide * rate) - 0.5) > 1e-3)
    step, small = constant_twist_step(yaw, speed, rate, duration, slide), 1e-5

    def slope(of, **change):
        up = {"yaw_rad": yaw, "speed_mps": speed, "yaw_rate_radps": rate, "duration_s": duration, "slide_s": slide}
        down = dict(up)
        for name in change:
            up[name] += small
            down[name] -= small
        return (getattr(constant_twist_step(**up), of) - getattr(constant_twist_step(**down), of)) / (2.0 * small)

    for axis in ("x", "y"):
        for suffix, name in (
            ("yaw", "yaw_rad"),
            ("speed", "speed_mps"),
            ("rate", "yaw_rate_radps"),
            ("slide", "slide_s"),
        ):
            expected = slope(f"{axis}_m", **{name: 1})
            assert getattr(step, f"{axis}_per_{suffix}") == pytest.approx(expected, abs=1e-6)
