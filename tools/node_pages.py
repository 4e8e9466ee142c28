"""Writes docs/nodes.md, every node and its parameters, from the nodes themselves: ``make docs``."""

from pathlib import Path

from node_kit.docs import render_nodes
from tracked_bringup.node_group import load_class
from tracked_bringup.node_table import load_node_table

PAGE = Path(__file__).resolve().parents[1] / "docs" / "nodes.md"
HEAD = """# Nodes and parameters

Made by `make docs` from the nodes' own parameter tables; change those, not this page. `./run PACKAGE EXECUTABLE --help`
shows the same of one node. Numbers of the robot are no parameters: they stand in `robot.yaml`, which the parameter
`robot_file` can exchange. [topics.md](topics.md) says what the nodes tell one another.

"""


def page() -> str:
    """The whole page."""
    table = load_node_table()
    packages = "\n".join(
        f"| [`{name}`](#{name}) | `./run {entry.package} {entry.executable}` |" for name, entry in table.nodes.items()
    )
    classes = [load_class(entry.node_class) for entry in table.nodes.values()]
    return f"{HEAD}| node | |\n|---|---|\n{packages}\n\n{render_nodes(classes)}"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
