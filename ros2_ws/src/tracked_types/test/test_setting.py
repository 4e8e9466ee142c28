from dataclasses import dataclass
from typing import Any

import pytest

from tracked_types.setting import check_settings, setting, settings_of


@dataclass(frozen=True, slots=True, kw_only=True)
class Example:
    gauge_m: float
    gain: float = setting(2.0, "how strongly it acts", unit="1/s", low=0.0, high=10.0)
    mode: str = setting("soft", "how it acts", choices=("soft", "hard"))
    enabled: bool = setting(True, "whether it acts")

    def __post_init__(self) -> None:
        check_settings(self)


def test_tunable_fields_are_listed_in_order_and_robot_fields_are_not() -> None:
    assert [declared.name for declared in settings_of(Example)] == ["gain", "mode", "enabled"]
    assert settings_of(Example)[0].default == 2.0


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"gain": -1.0}, "Example.gain must be at least 0 1/s"),
        ({"gain": 11.0}, "at most 10"),
        ({"gain": float("nan")}, "finite"),
        ({"gain": "2"}, "type float"),
        ({"mode": "other"}, "one of soft, hard"),
        ({"enabled": 1}, "type bool"),
    ],
)
def test_a_wrong_value_is_refused_by_name(wrong: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Example(gauge_m=0.3, **wrong)


def test_a_whole_number_serves_a_float_field() -> None:
    assert Example(gauge_m=0.3, gain=3).gain == 3
