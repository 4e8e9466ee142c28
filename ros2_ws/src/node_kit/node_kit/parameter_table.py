"""The parameters of a node, in one table that gives declaration, check, YAML and documentation."""

import difflib
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import yaml

from node_kit.parameter import BadParameterError, Parameter, Value
from tracked_types.setting import settings_of


class ParameterTable:
    """Parameters by name, in order of declaration.

    Raises
    ------
    ValueError: two different parameters have one name.
    """

    def __init__(self, *parameters: Parameter) -> None:
        self._by_name: dict[str, Parameter] = {}
        for parameter in parameters:
            known = self._by_name.setdefault(parameter.name, parameter)
            if known != parameter:
                raise ValueError(f"two different parameters are called {parameter.name}")

    @classmethod
    def from_settings(
        cls, *settings_classes: type, extra: Iterable[Parameter] = (), live: Iterable[str] = ()
    ) -> "ParameterTable":
        """Table of the tunable fields of settings dataclasses, then of ``extra``; ``live`` names fields to follow.

        Raises
        ------
        ValueError: two different parameters have one name, or ``live`` names none.
        """
        live_names = set(live)
        parameters = [
            Parameter.from_setting(setting, live=setting.name in live_names)
            for settings_class in settings_classes
            for setting in settings_of(settings_class)
        ]
        unknown = live_names - {parameter.name for parameter in parameters}
        if unknown:
            raise ValueError(f"live names no setting: {', '.join(sorted(unknown))}")
        return cls(*parameters, *extra)

    def __iter__(self) -> Iterator[Parameter]:
        return iter(self._by_name.values())

    def __len__(self) -> int:
        return len(self._by_name)

    def __contains__(self, name: object) -> bool:
        return name in self._by_name

    def __getitem__(self, name: str) -> Parameter:
        return self._by_name[name]

    def __add__(self, other: "ParameterTable") -> "ParameterTable":
        return ParameterTable(*self, *other)

    def checked(self, values: Mapping[str, Any]) -> dict[str, Value]:
        """Every parameter with its checked value from ``values`` or its default.

        Raises
        ------
        BadParameterError: one sentence per parameter that cannot be used.
        """
        checked: dict[str, Value] = {}
        problems = []
        for parameter in self:
            try:
                checked[parameter.name] = parameter.checked(values.get(parameter.name, parameter.default))
            except BadParameterError as error:
                problems.append(str(error))
        if problems:
            raise BadParameterError("; ".join(problems))
        return checked

    def unknown(self, names: Iterable[str]) -> list[str]:
        """A sentence per name that is not in the table, with the nearest one that is."""
        sentences = []
        for name in sorted(set(names) - set(self._by_name)):
            near = difflib.get_close_matches(name, self._by_name, n=1)
            sentences.append(f"parameter {name} is unknown" + (f" (did you mean {near[0]}?)" if near else ""))
        return sentences

    def to_yaml(self, node_name: str = "/**", values: Mapping[str, Any] | None = None) -> str:
        """A ROS parameter file with ``values`` (defaults where missing), descriptions as comments."""
        checked = self.checked(values or {})
        lines = [f"{node_name}:", "  ros__parameters:" if checked else "  ros__parameters: {}"]
        for parameter in self:
            value = checked[parameter.name]
            plain = list(value) if isinstance(value, tuple) else value
            entry = yaml.safe_dump({parameter.name: plain}, default_flow_style=True, width=10_000).strip()[1:-1]
            lines += [f"    # {_one_line(parameter)}", f"    {entry}"]
        return "\n".join(lines) + "\n"

    def to_markdown(self) -> str:
        """Table for the documentation."""
        rows = ["| parameter | type | default | unit | allowed | description |", "|---|---|---|---|---|---|"]
        for parameter in self:
            live = "; can be changed while the node runs" if parameter.live else ""
            description = parameter.description.rstrip(".") + live
            cells = (
                f"`{parameter.name}`",
                parameter.type_name,
                f"`{_plain(parameter.default)}`",
                parameter.unit,
                _allowed(parameter),
                description,
            )
            rows.append("| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |")
        return "\n".join(rows) + "\n"


def _plain(value: Value) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return f"[{', '.join(_plain(element) for element in value)}]"
    return '""' if value == "" else str(value)


def _allowed(parameter: Parameter) -> str:
    if parameter.choices:
        return ", ".join(parameter.choices)
    if parameter.low is not None and parameter.high is not None:
        return f"{parameter.low:g} to {parameter.high:g}"
    if parameter.low is not None:
        return f"at least {parameter.low:g}"
    return f"at most {parameter.high:g}" if parameter.high is not None else ""


def _one_line(parameter: Parameter) -> str:
    notes = [note for note in (parameter.unit, _allowed(parameter)) if note]
    description = " ".join(parameter.description.split())
    return f"{description} ({'; '.join(notes)})" if notes else description
