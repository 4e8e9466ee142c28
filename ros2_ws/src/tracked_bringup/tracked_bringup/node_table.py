"""The table of nodes: what there is, how it is started and what becomes of the run when it ends."""

from importlib import resources
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from tracked_types.checked_yaml import CheckedModel, load_checked_yaml

Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$")]
Topic = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_/]*$")]
ClassPath = Annotated[str, Field(pattern=r"^[A-Za-z_][\w.]*:[A-Za-z_]\w*$")]
Value = bool | int | float | str | list[float] | list[str]


class NodeEntry(CheckedModel):
    """One row of the table; see the comments in nodes.yaml."""

    package: Name
    executable: Name
    node_class: Annotated[ClassPath, Field(alias="class")]
    group: Name
    order: Annotated[int, Field(ge=0, le=100)] = 1
    publishes: tuple[Topic, ...] = ()
    publishes_if: dict[Topic, dict[Name, Value]] = Field(default_factory=dict)
    subscribes: tuple[Topic, ...] = ()
    optional: bool = False
    on_exit: Literal["stop", "restart"] = "stop"
    restarts: Annotated[int, Field(ge=0, le=1000)] = 3
    parameters: dict[Name, Value] = Field(default_factory=dict)


class NodeTable(CheckedModel):
    """Node name -> entry, in the order of the file."""

    nodes: Annotated[dict[Name, NodeEntry], Field(min_length=1)]

    @model_validator(mode="after")
    def _classes_differ(self) -> "NodeTable":
        seen: dict[str, str] = {}
        for name, entry in self.nodes.items():
            other = seen.setdefault(entry.node_class, name)
            if other != name:
                raise ValueError(f"nodes {other} and {name} have the same class {entry.node_class}")
        return self


def load_node_table(path: Path | None = None) -> NodeTable:
    """Read a node table; without a path, the packaged one.

    Raises
    ------
    CheckedFileError: if the file is missing, is not YAML, or a key is missing, unknown or malformed.
    """
    if path is not None:
        return load_checked_yaml(NodeTable, path)
    return load_checked_yaml(NodeTable, resources.files("tracked_bringup") / "data" / "nodes.yaml", "nodes.yaml")
