"""Which processes a variant of a scenario consists of, and with which parameters."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import yaml

from tracked_bringup.node_table import NodeEntry, NodeTable, Value
from tracked_description import load_robot
from tracked_report.node_parameters import node_parameters
from tracked_report.scenario import Scenario
from tracked_types import PeriodGrid, to_nanoseconds

Grouping = Literal["default", "separate"]
# Simulated time stands still until every endpoint is matched, so that no first sample is lost, and no later one may
# be lost either. The sensors of a robot are often best effort, which a reliable subscription would not hear.
_SIMULATED: dict[str, dict[str, Value]] = {
    "sim_bridge": {"start_paused": True},
    "ekf": {"reliable_sensors": True},
    "mapper": {"reliable_sensors": True},
    "localiser": {"reliable_sensors": True},
    "command_arbiter": {"reliable_sensors": True},
    "recorder": {"reliable_sensors": True},
    "slip_witness": {"reliable_sensors": True},
}
GROUPINGS: tuple[Grouping, ...] = ("default", "separate")


@dataclass(frozen=True, slots=True)
class NodePlan:
    """One node of a run: its row of the table and all parameters that differ from its defaults."""

    name: str
    entry: NodeEntry
    parameters: Mapping[str, Value]

    @property
    def publishes(self) -> tuple[str, ...]:
        """Topics it publishes with these parameters."""
        chosen = self.parameters.items()
        return self.entry.publishes + tuple(
            topic for topic, condition in self.entry.publishes_if.items() if condition.items() <= chosen
        )


@dataclass(frozen=True, slots=True)
class ProcessPlan:
    """Nodes that share a process, named after their group, or after the node where it is alone."""

    name: str
    nodes: tuple[NodePlan, ...]

    @property
    def order(self) -> int:
        """Processes of a lower order are up before this one is started."""
        return max(node.entry.order for node in self.nodes)

    @property
    def on_exit(self) -> Literal["stop", "restart"]:
        """The strictest policy of its nodes."""
        return "stop" if any(node.entry.on_exit == "stop" for node in self.nodes) else "restart"

    @property
    def restarts(self) -> int:
        """How often it may be started again: as often as its most delicate node."""
        return min(node.entry.restarts for node in self.nodes)


@dataclass(frozen=True, slots=True)
class GraphPlan:
    """Every process of one run, in the order of starting. ``namespace``: without slashes at its ends, may be empty."""

    processes: tuple[ProcessPlan, ...]
    namespace: str = ""

    @property
    def nodes(self) -> tuple[NodePlan, ...]:
        """All nodes."""
        return tuple(node for process in self.processes for node in process.nodes)

    def has(self, node: str) -> bool:
        """Whether a node of this name takes part."""
        return any(planned.name == node for planned in self.nodes)

    def publishers_of(self, topic: str) -> int:
        """How many of the nodes publish a topic, as the table says."""
        return sum(topic in planned.publishes for planned in self.nodes)

    def full_name(self, relative: str) -> str:
        """A relative topic, service or node name within the namespace."""
        return f"/{self.namespace}/{relative}" if self.namespace else f"/{relative}"

    def parameter_file(self, process: ProcessPlan) -> str:
        """Parameters of one process as a ROS parameter file."""
        content = {
            self.full_name(node.name): {"ros__parameters": dict(node.parameters)}
            for node in process.nodes
            if node.parameters
        }
        return yaml.safe_dump(content, sort_keys=False)

    def ros_arguments(self, parameter_file: Path) -> list[str]:
        """What follows ``--ros-args`` for every process."""
        arguments = ["--params-file", str(parameter_file)]
        if self.namespace:
            arguments += ["-r", f"__ns:=/{self.namespace}", "-r", f"/clock:=/{self.namespace}/clock"]
        return arguments


def plan_graph(
    table: NodeTable,
    scenario: Scenario,
    variant: str,
    *,
    grouping: Grouping = "default",
    namespace: str = "",
    extra: Mapping[str, Mapping[str, Value]] | None = None,
) -> GraphPlan:
    """The graph of one variant of a scenario.

    A namespace also becomes the prefix of all frames, so that several robots share one domain. ``extra``
    are parameters (node -> parameter -> value) that come last.

    Raises
    ------
    KeyError: for an unknown variant.
    CheckedFileError: if the scenario's robot file cannot be used.
    """
    namespace = namespace.strip("/")
    names = [name for name, entry in table.nodes.items() if _takes_part(name, entry, scenario, variant)]
    common: dict[str, Value] = {"use_sim_time": True} if "sim_bridge" in names else {}
    if scenario.robot:
        common["robot_file"] = str(Path(scenario.robot).resolve())
    if namespace:
        common["frame_prefix"] = f"{namespace}/"
    layers: list[Mapping[str, Mapping[str, Value]]] = [
        {name: {**common, **table.nodes[name].parameters} for name in names},
        _SIMULATED if "sim_bridge" in names else {},
        _first_command(scenario, variant) if "sim_bridge" in names else {},
        {node: {"lock_step": scenario.time == "lock_step"} for node in ("command_arbiter", "upper_nmpc")},
        node_parameters(scenario, variant),
        extra or {},
    ]
    by_process: dict[str, list[NodePlan]] = {}
    for name in names:
        parameters = {key: value for layer in layers for key, value in layer.get(name, {}).items()}
        node = NodePlan(name, table.nodes[name], parameters)
        by_process.setdefault(name if grouping == "separate" else node.entry.group, []).append(node)
    processes = [ProcessPlan(name, tuple(members)) for name, members in by_process.items()]
    return GraphPlan(tuple(sorted(processes, key=lambda process: process.order)), namespace)


def _first_command(scenario: Scenario, variant: str) -> dict[str, dict[str, Value]]:
    """When the simulator may expect the first command, so that every lock-step run starts alike.

    A plan is made at the first of its instants after time zero, and takes effect a latency later.
    """
    if scenario.time != "lock_step" or scenario.reference is None:
        return {}
    planner = node_parameters(scenario, variant)["upper_nmpc"]
    rate_hz, latency_s = int(str(planner["rate_hz"])), float(str(planner["pipeline_latency_s"]))
    effective_ns = PeriodGrid(rate_hz).stamp_ns(1) + to_nanoseconds(latency_s)
    control = PeriodGrid(load_robot(scenario.robot).control.rate_hz)
    return {"sim_bridge": {"first_command_s": control.stamp_ns(control.index_at(effective_ns - 1) + 1) * 1e-9}}


def _takes_part(node: str, entry: NodeEntry, scenario: Scenario, variant: str) -> bool:
    if node in scenario.nodes or entry.optional:
        return scenario.nodes.get(node, False)
    if node == "lower_nmpc":
        return scenario.drives and scenario.variants[variant].layers == "double"
    if node == "upper_nmpc":
        return scenario.drives
    return node != "trajectory_player" or scenario.reference is not None
