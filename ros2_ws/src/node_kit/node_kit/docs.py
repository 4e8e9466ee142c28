"""Documentation page of nodes, rendered from their parameter tables."""

import inspect
from collections.abc import Iterable
from typing import Protocol

from node_kit.common_parameters import COMMON_PARAMETERS
from node_kit.parameter_table import ParameterTable


class Documented(Protocol):
    """What a node class says of itself."""

    NAME: str
    PARAMETERS: ParameterTable


def render_nodes(node_classes: Iterable[type[Documented]], *, level: int = 2) -> str:
    """Markdown: per node a heading, its docstring and its parameters; then the parameters that every node has.

    ``level`` is that of the headings.
    """
    sections = []
    for node_class in node_classes:
        sections.append(f"{'#' * level} {node_class.NAME}\n")
        description = inspect.cleandoc(node_class.__doc__ or "").strip()
        if description:
            sections.append(f"{description}\n")
        table = node_class.PARAMETERS
        sections.append(table.to_markdown() if len(table) else "No parameters of its own.\n")
    sections.append(f"{'#' * level} Every node\n")
    sections.append(COMMON_PARAMETERS.to_markdown())
    return "\n".join(sections)
