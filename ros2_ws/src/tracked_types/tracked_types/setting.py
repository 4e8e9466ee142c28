"""Tunable settings: one declaration gives the default, the check, the ROS parameter and the documentation."""

import dataclasses
import math
from dataclasses import dataclass
from typing import Any, TypeVar, cast

Value = bool | int | float | str
Default = TypeVar("Default", bool, int, float, str)
_KEY = "setting"


@dataclass(frozen=True, slots=True)
class SettingInfo:
    """What is known of one tunable field besides its name, type and default."""

    description: str
    unit: str = ""
    low: float | None = None
    high: float | None = None
    choices: tuple[str, ...] = ()

    def problem(self, value: Any) -> str | None:
        """What is wrong with ``value``, in words, or None."""
        if isinstance(value, float) and not math.isfinite(value):
            return f"must be finite, got {value!r}"
        if self.low is not None and value < self.low:
            return f"must be at least {self.low:g}{self._unit_suffix}, got {value!r}"
        if self.high is not None and value > self.high:
            return f"must be at most {self.high:g}{self._unit_suffix}, got {value!r}"
        if self.choices and value not in self.choices:
            return f"must be one of {', '.join(self.choices)}; got {value!r}"
        return None

    @property
    def _unit_suffix(self) -> str:
        return f" {self.unit}" if self.unit else ""


@dataclass(frozen=True, slots=True)
class Setting:
    """A tunable field of a settings dataclass."""

    name: str
    default: Value
    info: SettingInfo


def setting(
    default: Default,
    description: str,
    *,
    unit: str = "",
    low: float | None = None,
    high: float | None = None,
    choices: tuple[str, ...] = (),
) -> Default:
    """A dataclass field that users may tune; its type is that of ``default``."""
    info = SettingInfo(description=description, unit=unit, low=low, high=high, choices=choices)
    return dataclasses.field(default=default, metadata={_KEY: info})


def settings_of(settings_class: type) -> tuple[Setting, ...]:
    """The tunable fields of a settings dataclass, in order of declaration."""
    tunable = [field for field in dataclasses.fields(settings_class) if _KEY in field.metadata]
    return tuple(Setting(field.name, cast(Value, field.default), field.metadata[_KEY]) for field in tunable)


def check_settings(instance: Any) -> None:
    """Check every tunable field of ``instance`` for type, finiteness, range and choice.

    Whole numbers are accepted for float fields. Call it from ``__post_init__``.

    Raises
    ------
    ValueError: naming the class, the field and what was expected.
    """
    for declared in settings_of(type(instance)):
        value = getattr(instance, declared.name)
        problem = type_problem(declared.default, value) or declared.info.problem(value)
        if problem:
            raise ValueError(f"{type(instance).__name__}.{declared.name} {problem}")


def type_problem(default: Value, value: Any) -> str | None:
    """Why ``value`` cannot stand where ``default`` does, or None."""
    expected = type(default)
    if expected is float and type(value) is int:
        return None
    if type(value) is expected:
        return None
    return f"must be of type {expected.__name__}, got {value!r}"
