"""Declares a parameter table on an rclpy node and keeps the values."""

from collections.abc import Callable
from typing import Any

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor, SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter as RosParameter

from node_kit.parameter import BadParameterError, Parameter, Value
from node_kit.parameter_table import ParameterTable

_LARGEST_FLOAT = 1.7976931348623157e308
_LARGEST_INTEGER = 2**63 - 1
_OF_ROS = ("use_sim_time", "start_type_description_service", "qos_overrides.")


class NodeParameters:
    """Values of a node's parameters.

    The node must have been made with ``automatically_declare_parameters_from_overrides``: what the user gave is taken
    from there, checked with reasons that name the parameter, and declared anew with type, range and description.

    changed: called with the new values after live parameters were set.

    Raises
    ------
    BadParameterError: one sentence per parameter that cannot be used.
    """

    def __init__(self, node: Node, table: ParameterTable, changed: Callable[[dict[str, Value]], None]) -> None:
        self._table = table
        self._changed = changed
        given = {name: parameter.value for name, parameter in node.get_parameters_by_prefix("").items()}
        self._values = table.checked(given)
        self.unknown = table.unknown(name for name in given if not name.startswith(_OF_ROS))
        for parameter in table:
            if node.has_parameter(parameter.name):
                node.undeclare_parameter(parameter.name)
            value = self._values[parameter.name]
            plain = list(value) if isinstance(value, tuple) else value
            node.declare_parameter(parameter.name, plain, descriptor(parameter), ignore_override=True)
        node.add_pre_set_parameters_callback(self._widen)
        node.add_on_set_parameters_callback(self._check)
        node.add_post_set_parameters_callback(self._store)

    def __getitem__(self, name: str) -> Value:
        return self._values[name]

    def __contains__(self, name: object) -> bool:
        return name in self._values

    def _widen(self, parameters: list[RosParameter]) -> list[RosParameter]:
        """Whole numbers given for float parameters become floats."""
        return [
            RosParameter(parameter.name, RosParameter.Type.DOUBLE, float(parameter.value))
            if parameter.type_ == RosParameter.Type.INTEGER
            and parameter.name in self._table
            and isinstance(self._table[parameter.name].default, float)
            else parameter
            for parameter in parameters
        ]

    def _check(self, parameters: list[RosParameter]) -> SetParametersResult:
        try:
            self._checked(parameters)
        except BadParameterError as error:
            return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _store(self, parameters: list[RosParameter]) -> None:
        changed = self._checked(parameters)
        if changed:
            self._values.update(changed)
            self._changed(changed)

    def _checked(self, parameters: list[RosParameter]) -> dict[str, Value]:
        return {
            parameter.name: self._table[parameter.name].checked(parameter.value)
            for parameter in parameters
            if parameter.name in self._table
        }


def descriptor(parameter: Parameter) -> ParameterDescriptor:
    """What tools show of a parameter: description with unit, range, choices, whether it can be changed."""
    unit = f" [{parameter.unit}]" if parameter.unit else ""
    described = ParameterDescriptor(
        name=parameter.name,
        description=f"{parameter.description}{unit}",
        read_only=not parameter.live,
        additional_constraints=f"one of {', '.join(parameter.choices)}" if parameter.choices else "",
    )
    if parameter.low is None and parameter.high is None:
        return described
    if type(parameter.default) is float:
        low = -_LARGEST_FLOAT if parameter.low is None else float(parameter.low)
        high = _LARGEST_FLOAT if parameter.high is None else float(parameter.high)
        described.floating_point_range = [FloatingPointRange(from_value=low, to_value=high)]
    elif type(parameter.default) is int:
        least = -_LARGEST_INTEGER if parameter.low is None else int(parameter.low)
        most = _LARGEST_INTEGER if parameter.high is None else int(parameter.high)
        described.integer_range = [IntegerRange(from_value=least, to_value=most)]
    return described


def value_or_ros(parameters: NodeParameters, node: Node, name: str) -> Any:
    """Value from the table, or of a parameter that rclpy itself declares."""
    return parameters[name] if name in parameters else node.get_parameter(name).value
