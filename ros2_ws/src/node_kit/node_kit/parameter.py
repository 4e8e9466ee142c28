"""One parameter of a node: its default, its check and its description."""

from dataclasses import dataclass
from typing import Any

from tracked_types.setting import Setting, SettingInfo, type_problem

Value = bool | int | float | str | tuple[float, ...] | tuple[str, ...]


class BadParameterError(ValueError):
    """A parameter cannot be used; the text names the parameter and what was expected."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """Declaration of one node parameter.

    default: gives the type: bool, int, float, str, or a tuple of floats or strings with at least one element.
    unit: of the value, for the documentation; empty for none.
    low, high: inclusive limits of numbers (of every element of a tuple).
    choices: the only texts allowed.
    live: whether the node follows changes while it runs (`StackNode.parameters_changed`); all others are read-only.

    Raises
    ------
    ValueError: the default does not pass its own check, or the description is missing.
    """

    name: str
    default: Value
    description: str
    unit: str = ""
    low: float | None = None
    high: float | None = None
    choices: tuple[str, ...] = ()
    live: bool = False

    def __post_init__(self) -> None:
        if not self.name or not self.description:
            raise ValueError(f"parameter {self.name!r} needs a name and a description")
        self.checked(self.default)

    @classmethod
    def from_setting(cls, setting: Setting, *, live: bool = False) -> "Parameter":
        """The parameter of a tunable field of a settings dataclass."""
        info = setting.info
        return cls(setting.name, setting.default, info.description, info.unit, info.low, info.high, info.choices, live)

    @property
    def type_name(self) -> str:
        """Name of the type, as the documentation calls it."""
        if isinstance(self.default, tuple):
            return f"list of {type(self.default[0]).__name__}"
        return type(self.default).__name__

    def checked(self, value: Any) -> Value:
        """``value`` in the type of the default: whole numbers become floats, sequences become tuples.

        Raises
        ------
        BadParameterError: naming the parameter and what was expected.
        """
        if not isinstance(self.default, tuple):
            scalar: Value = self._checked_scalar(value, self.default)
            return scalar
        if not self.default:
            raise ValueError(f"parameter {self.name}: the default must have an element, to give the type")
        if isinstance(value, str) or not hasattr(value, "__iter__"):
            raise BadParameterError(f"parameter {self.name} must be a {self.type_name}, got {value!r}")
        return tuple(self._checked_scalar(element, self.default[0]) for element in value)

    def _checked_scalar(self, value: Any, default: Any) -> Any:
        if type(default) not in (bool, int, float, str):
            raise ValueError(f"parameter {self.name}: no parameter can be a {type(default).__name__}")
        converted = float(value) if type(default) is float and type(value) is int else value
        problem = type_problem(default, converted) or self._info.problem(converted)
        if problem:
            raise BadParameterError(f"parameter {self.name} {problem}")
        return converted

    @property
    def _info(self) -> SettingInfo:
        return SettingInfo(self.description, unit=self.unit, low=self.low, high=self.high, choices=self.choices)
