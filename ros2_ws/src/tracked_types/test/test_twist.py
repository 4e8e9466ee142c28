import math

from hypothesis import given
from hypothesis import strategies as st

from tracked_types import Twist2

values = st.floats(min_value=-10.0, max_value=10.0)
steps = st.floats(min_value=0.0, max_value=20.0)


def test_each_component_goes_its_step_towards_zero_and_not_past_it() -> None:
    assert Twist2(0.5, -1.0).towards_rest(0.2, 0.4) == Twist2(0.3, -0.6)
    assert Twist2(-0.1, 0.3).towards_rest(0.2, 0.4) == Twist2(0.0, 0.0)


@given(values, values, steps, steps)
def test_the_way_to_rest_keeps_signs_and_shrinks(speed: float, yaw_rate: float, step: float, yaw_step: float) -> None:
    slower = Twist2(speed, yaw_rate).towards_rest(step, yaw_step)
    for before, after in ((speed, slower.speed_mps), (yaw_rate, slower.yaw_rate_radps)):
        assert after == 0.0 or math.copysign(1.0, after) == math.copysign(1.0, before)
        assert abs(after) <= abs(before)
