"""The only glue between algorithms and rclpy; nothing about robots in it.

Importing this package does not import rclpy: the names that need it are loaded when first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from node_kit.diagnostics import Level
from node_kit.parameter import BadParameterError, Parameter
from node_kit.parameter_table import ParameterTable
from node_kit.rejection import RejectedMessage
from node_kit.rigid_transform import RigidTransform
from node_kit.transform_buffer import TransformBuffer, TransformError

if TYPE_CHECKING:
    from node_kit import qos
    from node_kit.node import StackNode
    from node_kit.process import run
    from node_kit.transforms import TransformListener

__all__ = [
    "BadParameterError",
    "Level",
    "Parameter",
    "ParameterTable",
    "RejectedMessage",
    "RigidTransform",
    "StackNode",
    "TransformBuffer",
    "TransformError",
    "TransformListener",
    "qos",
    "run",
]

_NEED_RCLPY = {
    "StackNode": "node_kit.node",
    "TransformListener": "node_kit.transforms",
    "run": "node_kit.process",
}


def __getattr__(name: str) -> Any:
    if name in _NEED_RCLPY:
        return getattr(import_module(_NEED_RCLPY[name]), name)
    if name == "qos":
        return import_module("node_kit.qos")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
