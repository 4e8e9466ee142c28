"""Node parameters without nodes: the same names and values, handed to the settings they belong to."""

from collections.abc import Mapping
from typing import Any

from tracked_types.setting import settings_of

NodeParameters = Mapping[str, Mapping[str, Any]]
"""Node name -> parameter name -> value, as `tracked_report.node_parameters.node_parameters` gives them."""


class UnknownParameterError(ValueError):
    """A parameter belongs to no settings of its node; the text names node and parameter."""


def tuning_of(settings_class: type, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """The ``parameters`` that are tunable fields of ``settings_class``, as keyword arguments for it."""
    return {
        declared.name: parameters[declared.name]
        for declared in settings_of(settings_class)
        if declared.name in parameters
    }


def check_known(node: str, parameters: Mapping[str, Any], settings_classes: tuple[type, ...], *others: str) -> None:
    """Refuse parameters that no settings class of the node knows; ``others`` names those the caller handles.

    Raises
    ------
    UnknownParameterError: naming the first parameter that nobody would read.
    """
    known = {declared.name for settings in settings_classes for declared in settings_of(settings)} | set(others)
    for name in parameters:
        if name not in known:
            raise UnknownParameterError(f"{node} has no parameter {name!r}; it has {', '.join(sorted(known))}")
