import pytest

from nmpc_layers.creep import CREEP_SPEED_MPS, CREEP_YAW_RATE_RADPS, without_creep
from tracked_types import Twist2


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_commands_that_only_follow_noise_become_rest(sign: float) -> None:
    assert without_creep(Twist2(sign * 0.9 * CREEP_SPEED_MPS, -sign * 0.9 * CREEP_YAW_RATE_RADPS)) == Twist2(0.0, 0.0)


@pytest.mark.parametrize(
    "meant", [Twist2(CREEP_SPEED_MPS, 0.0), Twist2(-0.1, 0.001), Twist2(0.0, -CREEP_YAW_RATE_RADPS), Twist2(0.001, 0.3)]
)
def test_commands_that_are_meant_stay_as_they_are(meant: Twist2) -> None:
    assert without_creep(meant) == meant
