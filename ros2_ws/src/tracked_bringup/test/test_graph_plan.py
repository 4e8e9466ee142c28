from importlib import resources

import pytest
import yaml

from tracked_bringup.graph_plan import GraphPlan, plan_graph
from tracked_bringup.node_table import load_node_table
from tracked_bringup.scenarios import load_scenario
from tracked_types.checked_yaml import CheckedFileError

TABLE = load_node_table()


def plan(name: str = "compare", variant: str = "double", *changes: str, **options: object) -> GraphPlan:
    return plan_graph(TABLE, load_scenario(name, changes, TABLE), variant, **options)  # type: ignore[arg-type]


def parameters(graph: GraphPlan, node: str) -> dict[str, object]:
    return dict(next(planned.parameters for planned in graph.nodes if planned.name == node))


def test_nodes_share_processes_by_group_or_have_one_each() -> None:
    assert {process.name for process in plan().processes} == {
        "simulator",
        "control",
        "planning",
        "safety",
        "recording",
    }
    separate = plan(grouping="separate")
    assert all(len(process.nodes) == 1 for process in separate.processes)
    assert {node.name for node in separate.nodes} == {node.name for node in plan().nodes}


def test_the_single_layer_runs_without_the_lower_one() -> None:
    assert not plan(variant="single").has("lower_nmpc")
    assert parameters(plan(variant="single"), "upper_nmpc")["layers"] == "single"
    assert plan(variant="double").has("lower_nmpc")


def test_without_a_reference_nobody_plans() -> None:
    graph = plan("idle")
    assert not any(graph.has(node) for node in ("trajectory_player", "upper_nmpc", "lower_nmpc"))
    assert graph.has("command_arbiter") and graph.has("ekf")


def test_optional_nodes_take_part_where_they_are_named() -> None:
    assert not plan("track").has("mcap_recorder") and not plan("track").has("replay")
    graph = plan("track", "double", "nodes.mcap_recorder:=true")
    assert graph.has("mcap_recorder") and not graph.has("replay")
    recorder = next(process for process in graph.processes if process.name == "raw_recording")
    commanding = next(process for process in graph.processes if process.name == "control")
    assert recorder.order < commanding.order, "it hears the first command"


def test_nodes_can_be_left_out() -> None:
    graph = plan("track", "double", "nodes.sim_bridge:=false")
    assert not graph.has("sim_bridge")
    assert "use_sim_time" not in parameters(graph, "ekf")


def test_lock_step_reaches_everyone_who_must_wait() -> None:
    locked, paced = plan(), plan("compare", "double", "time:=paced")
    assert parameters(locked, "sim_bridge")["time_mode"] == "lock_step"
    for node in ("upper_nmpc", "lower_nmpc", "command_arbiter"):
        assert parameters(locked, node)["lock_step"] is True
        assert parameters(paced, node)["lock_step"] is False


def test_lock_step_knows_when_the_first_command_comes() -> None:
    for latency_s, expected_s in ((0.0, 0.2), (0.1, 0.3), (0.11, 1.0 / 3.0)):
        simulator = parameters(plan("compare", "double", f"pipeline_latency_s:={latency_s}"), "sim_bridge")
        assert abs(simulator["first_command_s"] - expected_s) < 1e-8  # type: ignore[operator]
    simulator = parameters(plan("compare", "double", "upper_nmpc.rate_hz:=10"), "sim_bridge")
    assert abs(simulator["first_command_s"] - 0.2) < 1e-8  # type: ignore[operator]
    assert "first_command_s" not in parameters(plan("idle"), "sim_bridge")


def test_the_first_commands_of_either_layer_are_waited_for() -> None:
    for variant, node in (("single", "upper_nmpc"), ("double", "lower_nmpc")):
        graph = plan(variant=variant)
        publishers = [planned.name for planned in graph.nodes if "cmd_vel_nav" in planned.publishes]
        assert publishers == [node]
        assert graph.publishers_of("cmd_vel_nav") == 1


def test_sensors_are_heard_without_loss_where_they_are_simulated() -> None:
    simulated, real = plan(), plan("track", "double", "nodes.sim_bridge:=false")
    for node in ("ekf", "recorder"):
        assert parameters(simulated, node)["reliable_sensors"] is True
        assert "reliable_sensors" not in parameters(real, node)


def test_every_node_gets_the_robot_of_the_scenario() -> None:
    packaged = resources.files("tracked_description") / "data" / "robot.yaml"
    graph = plan("compare", "double", f"robot:={packaged}")
    assert {node.parameters["robot_file"] for node in graph.nodes} == {str(packaged)}
    assert all("robot_file" not in node.parameters for node in plan().nodes)
    with pytest.raises(CheckedFileError, match="cannot be read"):
        plan("compare", "double", "robot:=no_robot.yaml")


def test_time_waits_until_the_graph_is_complete() -> None:
    assert parameters(plan(), "sim_bridge")["start_paused"] is True


def test_parameters_given_for_a_node_win() -> None:
    graph = plan("compare", "double", "sim_bridge.seed:=99", extra={"upper_nmpc": {"horizon": 12}})
    assert parameters(graph, "sim_bridge")["seed"] == 99
    assert parameters(graph, "upper_nmpc")["horizon"] == 12


def test_a_namespace_moves_nodes_and_frames_and_clock() -> None:
    from pathlib import Path

    graph = plan(namespace="/r1/")
    assert graph.full_name("odom") == "/r1/odom"
    assert parameters(graph, "ekf")["frame_prefix"] == "r1/"
    arguments = graph.ros_arguments(Path("p.yaml"))
    assert "__ns:=/r1" in arguments and "/clock:=/r1/clock" in arguments
    assert plan().ros_arguments(Path("p.yaml")) == ["--params-file", "p.yaml"]
    assert plan().full_name("odom") == "/odom"


def test_the_parameter_file_names_every_node_of_the_process() -> None:
    graph = plan(namespace="r1")
    control = next(process for process in graph.processes if process.name == "control")
    content = yaml.safe_load(graph.parameter_file(control))
    assert set(content) == {"/r1/ekf", "/r1/lower_nmpc"}
    assert content["/r1/lower_nmpc"]["ros__parameters"]["pipeline_latency_s"] == 0.1


def test_a_process_is_as_strict_as_its_strictest_node() -> None:
    for process in plan().processes:
        if any(node.entry.on_exit == "stop" for node in process.nodes):
            assert process.on_exit == "stop"
        assert process.restarts == min(node.entry.restarts for node in process.nodes)
        assert process.order == max(node.entry.order for node in process.nodes)
