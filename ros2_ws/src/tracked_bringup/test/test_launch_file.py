"""The launch file against stand-ins for launch and launch_ros, which are not installed where the tests run."""

import importlib.util
import sys
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from tracked_bringup.node_table import load_node_table
from tracked_bringup.scenarios import ArgumentError

LAUNCH_FILE = Path(__file__).parents[1] / "launch" / "bringup.launch.py"


def not_installed(package: str) -> str:
    raise LookupError(package)


class Action:
    def __init__(self, *positional: Any, **keywords: Any) -> None:
        self.positional = positional
        self.keywords = keywords


@dataclass
class Context:
    values: dict[str, str] = field(default_factory=dict)


class LaunchConfiguration(Action):
    def perform(self, context: Context) -> str:
        return context.values[self.positional[0]]


@pytest.fixture
def launch_file(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    contents: dict[str, tuple[str, ...]] = {
        "launch": ("LaunchDescription",),
        "launch.actions": ("DeclareLaunchArgument", "OpaqueFunction", "Shutdown"),
        "launch.substitutions": (),
        "launch_ros": (),
        "launch_ros.actions": ("Node",),
    }
    for name, classes in contents.items():
        module = ModuleType(name)
        for class_name in classes:
            setattr(module, class_name, type(class_name, (Action,), {}))
        monkeypatch.setitem(sys.modules, name, module)
    sys.modules["launch.substitutions"].LaunchConfiguration = LaunchConfiguration  # type: ignore[attr-defined]
    spec = importlib.util.spec_from_file_location("bringup_launch", LAUNCH_FILE)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def actions(launch_file: ModuleType, **values: str) -> dict[str, dict[str, Any]]:
    description = launch_file.generate_launch_description()
    *declared, opaque = description.positional[0]
    defaults = {argument.positional[0]: argument.keywords["default_value"] for argument in declared}
    nodes = opaque.keywords["function"](Context({**defaults, "simulated": "true", **values}))
    return {node.keywords["name"]: node.keywords for node in nodes}


def test_every_node_of_the_table_is_launched_from_its_row(launch_file: ModuleType) -> None:
    launched = actions(launch_file)
    table = load_node_table().nodes
    assert set(launched) == {name for name, entry in table.items() if not entry.optional} - {"recorder"}
    for name, keywords in launched.items():
        assert (keywords["package"], keywords["executable"]) == (table[name].package, table[name].executable)
        assert keywords["respawn"] == (table[name].on_exit == "restart")
        assert (keywords["on_exit"] is not None) == (table[name].on_exit == "stop")


def test_time_does_not_wait_for_somebody_who_is_not_there(launch_file: ModuleType) -> None:
    assert actions(launch_file)["sim_bridge"]["parameters"][0]["start_paused"] is False


def test_arguments_choose_scenario_variant_namespace_and_changes(launch_file: ModuleType) -> None:
    launched = actions(
        launch_file,
        scenario="compare",
        variant="single",
        namespace="r1",
        changes="seed:=42 nodes.description:=false",
        record="run.npz",
    )
    assert "lower_nmpc" not in launched and "description" not in launched
    assert launched["sim_bridge"]["parameters"][0]["seed"] == 42
    assert launched["recorder"]["parameters"][0]["record_file"] == "run.npz"
    assert all(keywords["namespace"] == "r1" for keywords in launched.values())
    assert launched["ekf"]["remappings"] == [("/clock", "/r1/clock")]


def test_a_scenario_with_faults_is_refused(launch_file: ModuleType) -> None:
    with pytest.raises(ArgumentError, match="faults"):
        actions(launch_file, changes="'faults:=[{at_s: 1.0, kind: nan, target: imu}]'")


@pytest.mark.parametrize("choice", ["false", "auto"])
def test_a_robot_leaves_the_simulator_out(
    launch_file: ModuleType, monkeypatch: pytest.MonkeyPatch, choice: str
) -> None:
    monkeypatch.setattr(launch_file, "get_package_prefix", not_installed)
    launched = actions(launch_file, simulated=choice)
    assert "sim_bridge" not in launched
    assert launched["ekf"]["parameters"][0].keys().isdisjoint({"use_sim_time", "reliable_sensors"})


def test_where_the_simulator_is_installed_it_is_launched(
    launch_file: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(launch_file, "get_package_prefix", lambda package: f"/opt/{package}")
    assert "sim_bridge" in actions(launch_file, simulated="auto")
    with pytest.raises(ArgumentError, match="simulated is true, false or auto"):
        actions(launch_file, simulated="perhaps")
