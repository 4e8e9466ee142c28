"""package.xml against the imports: a package states what it uses and nothing else."""

import ast
import sys
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tests.support.node_process import ROOT
from tracked_bringup.node_table import load_node_table

SOURCE = ROOT / "ros2_ws" / "src"
PACKAGES = sorted(file.parent.name for file in SOURCE.glob("*/setup.py"))
KEYS = {
    "cv2": "python3-opencv",
    "hypothesis": "python3-hypothesis",
    "jinja2": "python3-jinja2",
    "markupsafe": "python3-jinja2",
    "matplotlib": "python3-matplotlib",
    "numba": "python3-numba",
    "numpy": "python3-numpy",
    "pydantic": "python3-pydantic",
    "pytest": "python3-pytest",
    "yaml": "python3-yaml",
}
# From PyPI, with no key of their own (setup.py and requirements/ state them), or only where they happen to be.
WITHOUT_KEY = {
    *(
        "casadi",
        "clarabel",
        "cloudpickle",
        "cvxopt",
        "dask",
        "daqp",
        "distributed",
        "do_mpc",
        "filterpy",
        "flint",
        "gtsam",
        "pyarrow",
    ),
    *("pybullet", "rosbags", "rosidl_parser", "scipy"),
}
# A robot does not have the simulator: its package is imported late, and only for simulated runs.
OPTIONAL = {("tracked_bringup", "sim_bridge")}


def imported(folder: Path) -> Iterator[str]:
    """Top-level names of every import below ``folder``."""
    for file in folder.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                yield from (alias.name.partition(".")[0] for alias in node.names)
            elif isinstance(node, ast.ImportFrom) and node.module:
                yield node.module.partition(".")[0]


def needed(package: str, *folders: str) -> set[str]:
    """What the imports below these folders of a package amount to in a manifest."""
    names = {name for folder in folders for name in imported(SOURCE / package / folder)}
    names -= {package, "conftest"} | WITHOUT_KEY | set(sys.stdlib_module_names)
    return {KEYS.get(name, name) for name in names if (package, name) not in OPTIONAL}


def stated(package: str, kind: str) -> set[str]:
    root = ElementTree.parse(SOURCE / package / "package.xml").getroot()
    return {element.text or "" for element in root.iter(kind)} - {"python3-filterpy-pip"}


@pytest.mark.parametrize("package", PACKAGES)
def test_a_package_states_what_it_imports_and_nothing_else(package: str) -> None:
    wanted = needed(package, package, "launch")
    if package == "tracked_bringup":  # it starts the nodes by their names
        wanted |= {entry.package for entry in load_node_table().nodes.values()} - {package, "sim_bridge"}
    assert stated(package, "exec_depend") == wanted


@pytest.mark.parametrize("package", PACKAGES)
def test_a_package_states_what_its_tests_import_besides(package: str) -> None:
    assert stated(package, "test_depend") >= needed(package, "test") - stated(package, "exec_depend")
