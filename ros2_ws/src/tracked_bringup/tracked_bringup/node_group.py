"""Hosts several nodes in one process: ``node_group module:Class [module:Class ...] [--ros-args ...]``."""

import sys
from collections.abc import Sequence
from importlib import import_module
from typing import Any

USAGE = "usage: node_group MODULE:CLASS [MODULE:CLASS ...] [--ros-args ...]"


class NodeClassError(ValueError):
    """A node class cannot be loaded; the text names it and says why."""


def load_class(path: str) -> Any:
    """The class that ``module:Class`` names.

    Raises
    ------
    NodeClassError: if the form is wrong, or there is no such module or class.
    """
    module_name, separator, class_name = path.partition(":")
    if not (separator and module_name and class_name):
        raise NodeClassError(f"expected MODULE:CLASS, got {path!r}")
    try:
        module = import_module(module_name)
    except ImportError as error:
        raise NodeClassError(f"{path}: cannot be imported ({error})") from error
    if not isinstance(getattr(module, class_name, None), type):
        raise NodeClassError(f"{path}: {module_name} has no class {class_name}")
    return getattr(module, class_name)


def split_arguments(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """Class paths, and everything from ``--ros-args`` on."""
    if "--ros-args" in arguments:
        border = list(arguments).index("--ros-args")
        return list(arguments[:border]), list(arguments[border:])
    return list(arguments), []


def main() -> int:
    """Run the nodes; the exit code of the process, 2 for arguments that name no node."""
    paths, ros_arguments = split_arguments(sys.argv[1:])
    if not paths or paths[0] in ("-h", "--help"):
        print(USAGE, file=sys.stdout if paths else sys.stderr)
        return 0 if paths else 2
    try:
        classes = [load_class(path) for path in paths]
    except NodeClassError as error:
        print(f"node_group: {error}", file=sys.stderr)
        return 2
    from node_kit import run

    return run(*classes, args=[sys.argv[0], *ros_arguments])


if __name__ == "__main__":
    sys.exit(main())
