"""``ros2 launch tracked_bringup bringup.launch.py scenario:=track``: the nodes of one variant of a scenario.

The same node table and scenarios as ``./run bringup``, one process per node; faults need the latter. Where the
simulator is not installed, as on a robot, it is left out; ``simulated:=false`` leaves it out anywhere.
"""

import shlex

from ament_index_python.packages import get_package_prefix
from launch.actions import DeclareLaunchArgument, OpaqueFunction, Shutdown
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from launch import LaunchDescription
from tracked_bringup.graph_plan import plan_graph
from tracked_bringup.node_table import load_node_table
from tracked_bringup.scenarios import ArgumentError, load_scenario

ARGUMENTS = (
    ("scenario", "track", "name of a packaged scenario, or path of a .yaml file"),
    ("variant", "", "variant of the scenario; empty: its last one"),
    ("namespace", "", "namespace of all nodes and prefix of all frames"),
    (
        "simulated",
        "auto",
        "true: with sim_bridge; false: on a robot; auto: true where sim_bridge is installed",
    ),
    ("changes", "", "changes as of ./run bringup, separated by spaces"),
    ("record", "", "file that the run is recorded to; empty: not recorded"),
)


def nodes_of(context):
    """One action per node of the chosen variant."""
    values = {name: LaunchConfiguration(name).perform(context) for name, _, _ in ARGUMENTS}
    table = load_node_table()
    recorded = f"nodes.recorder:={'true' if values['record'] else 'false'}"
    simulated = f"nodes.sim_bridge:={'true' if is_simulated(values['simulated']) else 'false'}"
    scenario = load_scenario(values["scenario"], [recorded, simulated, *shlex.split(values["changes"])], table)
    if scenario.faults:
        raise ArgumentError("only ./run bringup injects the faults of a scenario")
    plan = plan_graph(
        table,
        scenario,
        values["variant"] or list(scenario.variants)[-1],
        grouping="separate",
        namespace=values["namespace"],
        # Nobody here waits for endpoints and then starts the time.
        extra={"sim_bridge": {"start_paused": False}, "recorder": {"record_file": values["record"]}},
    )
    return [
        Node(
            package=node.entry.package,
            executable=node.entry.executable,
            name=node.name,
            namespace=plan.namespace,
            parameters=[dict(node.parameters)],
            remappings=[("/clock", plan.full_name("clock"))],
            respawn=node.entry.on_exit == "restart",
            on_exit=Shutdown(reason=f"{node.name} has ended") if node.entry.on_exit == "stop" else None,
            output="screen",
        )
        for node in plan.nodes
    ]


def is_simulated(choice):
    """Whether the base is simulated."""
    if choice not in ("auto", "true", "false"):
        raise ArgumentError(f"simulated is true, false or auto, got {choice!r}")
    if choice != "auto":
        return choice == "true"
    try:
        get_package_prefix("sim_bridge")
    except LookupError:
        return False
    return True


def generate_launch_description():
    """Called by launch."""
    declared = [
        DeclareLaunchArgument(name, default_value=default, description=description)
        for name, default, description in ARGUMENTS
    ]
    return LaunchDescription([*declared, OpaqueFunction(function=nodes_of)])
