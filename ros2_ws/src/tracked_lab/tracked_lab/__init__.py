"""The stack in one process and in lock-step, without ROS: where evidence is made.

The names that need the physics engine are loaded when first used, so that the kinematic plant costs nothing of it.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tracked_lab.conditions import Conditions, Link, Links
    from tracked_lab.lock_step import drive
    from tracked_lab.stack import Reaction, Stack

__all__ = ["Conditions", "Link", "Links", "Reaction", "Stack", "drive"]

_HOMES = {
    "Conditions": "tracked_lab.conditions",
    "Link": "tracked_lab.conditions",
    "Links": "tracked_lab.conditions",
    "Reaction": "tracked_lab.stack",
    "Stack": "tracked_lab.stack",
    "drive": "tracked_lab.lock_step",
}


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
