from importlib import import_module
from pathlib import Path

import pytest
import yaml

from tracked_bringup.node_table import load_node_table
from tracked_types.checked_yaml import CheckedFileError

ENTRY = {"package": "a_package", "executable": "a_node", "class": "a_package.nodes.a_node:ANode", "group": "a_group"}


def write(folder: Path, nodes: object) -> Path:
    path = folder / "nodes.yaml"
    path.write_text(yaml.safe_dump({"nodes": nodes}))
    return path


def test_every_node_of_the_packaged_table_is_a_node_class_of_that_name() -> None:
    for name, entry in load_node_table().nodes.items():
        module, _, class_name = entry.node_class.partition(":")
        assert name == getattr(import_module(module), class_name).NAME
        assert module.startswith(f"{entry.package}.nodes.")


def test_every_node_of_the_packaged_table_has_somebody_to_listen_to() -> None:
    entries = load_node_table().nodes
    published = {topic for entry in entries.values() for topic in (*entry.publishes, *entry.publishes_if)}
    for name, entry in entries.items():
        assert set(entry.subscribes) <= published, name


def test_only_the_arbiter_publishes_commands_to_the_base() -> None:
    publishers = [name for name, entry in load_node_table().nodes.items() if "cmd_vel" in entry.publishes]
    assert publishers == ["command_arbiter"]


def test_the_arbiter_has_a_process_of_its_own() -> None:
    groups = [entry.group for entry in load_node_table().nodes.values()]
    assert groups.count(load_node_table().nodes["command_arbiter"].group) == 1


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"on_exit": "explode"}, "nodes.a_node.on_exit"),
        ({"class": "no_colon"}, "nodes.a_node.class"),
        ({"order": -1}, "nodes.a_node.order"),
        ({"publishes": ["/absolute"]}, "nodes.a_node.publishes.0"),
        ({"colour": "red"}, "nodes.a_node.colour"),
        ({"package": None}, "nodes.a_node.package"),
    ],
)
def test_a_malformed_entry_is_refused_by_key(tmp_path: Path, change: dict[str, object], words: str) -> None:
    with pytest.raises(CheckedFileError, match=words):
        load_node_table(write(tmp_path, {"a_node": {**ENTRY, **change}}))


def test_two_nodes_of_one_class_are_refused(tmp_path: Path) -> None:
    with pytest.raises(CheckedFileError, match="a_node and another have the same class"):
        load_node_table(write(tmp_path, {"a_node": ENTRY, "another": ENTRY}))


@pytest.mark.parametrize("nodes", [{}, None, [1], {"Bad Name": ENTRY}])
def test_a_table_without_nodes_is_refused(tmp_path: Path, nodes: object) -> None:
    with pytest.raises(CheckedFileError, match="nodes"):
        load_node_table(write(tmp_path, nodes))
