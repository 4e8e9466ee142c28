import os
import stat
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from tracked_bringup.graph_plan import GraphPlan, NodePlan, ProcessPlan
from tracked_bringup.node_table import NodeEntry
from tracked_bringup.supervisor import GraphFailedError, StopRequest, Supervisor, child_environment, command_of

LIMIT_S = 10.0
WAITS = "#!/bin/sh\ntrap 'exit 0' INT\necho ready $@\nwhile :; do sleep 0.02; done\n"
FAILS = "#!/bin/sh\necho 'it hurts'\nexit 7\n"


def node(name: str, on_exit: str = "stop", order: int = 1, restarts: int = 2) -> NodePlan:
    entry = NodeEntry.model_validate(
        {
            "package": "a_package",
            "executable": name,
            "class": f"a_package.nodes.{name}:Node",
            "group": name,
            "order": order,
            "on_exit": on_exit,
            "restarts": restarts,
        }
    )
    return NodePlan(name, entry, {"gain": 1.5})


def supervisor(tmp_path: Path, said: list[str], scripts: dict[str, str], *nodes: NodePlan) -> Supervisor:
    for name, script in scripts.items():
        path = tmp_path / name
        path.write_text(script)
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
    plan = GraphPlan(tuple(ProcessPlan(planned.name, (planned,)) for planned in nodes))
    return Supervisor(
        plan,
        locate=lambda _package, executable: str(tmp_path / executable),
        logs=tmp_path / "logs",
        environment=dict(os.environ),
        say=said.append,
        verbose=True,
    )


def until(condition: Callable[[], object]) -> None:
    deadline = time.monotonic() + LIMIT_S
    while not condition():
        assert time.monotonic() < deadline
        os.sched_yield()


def test_processes_are_started_by_order_with_their_parameter_file(tmp_path: Path) -> None:
    said: list[str] = []
    scripts = {"first": WAITS, "second": WAITS}
    graph = supervisor(tmp_path, said, scripts, node("second", order=5), node("first", order=2))
    assert graph.orders == [2, 5]
    assert [process.name for process in graph.start(2)] == ["first"]
    until(lambda: said)
    assert said == [f"[first] ready --ros-args --params-file {tmp_path}/logs/first.yaml"]
    assert "gain: 1.5" in (tmp_path / "logs" / "first.yaml").read_text()
    assert not graph.processes["second"].is_running
    assert graph.end() == {"second": None, "first": 0}


def test_the_end_of_a_needed_process_ends_the_run_with_its_last_words(tmp_path: Path) -> None:
    graph = supervisor(tmp_path, [], {"fails": FAILS}, node("fails"))
    graph.start(1)
    assert graph.processes["fails"].wait(LIMIT_S)
    with pytest.raises(GraphFailedError, match=r"fails ended \(exit code 7\):\nit hurts"):
        graph.check()


def test_a_process_is_started_again_as_often_as_its_policy_says(tmp_path: Path) -> None:
    said: list[str] = []
    graph = supervisor(tmp_path, said, {"fails": FAILS}, node("fails", on_exit="restart", restarts=2))
    graph.start(1)
    for attempt in (1, 2):
        assert graph.processes["fails"].wait(LIMIT_S)
        graph.check()
        assert any(f"started again, {attempt} of 2" in line for line in said)
    assert graph.processes["fails"].wait(LIMIT_S)
    with pytest.raises(GraphFailedError, match="fails ended"):
        graph.check()


def test_nothing_may_end_while_the_graph_starts(tmp_path: Path) -> None:
    graph = supervisor(tmp_path, [], {"fails": FAILS}, node("fails", on_exit="restart"))
    graph.start(1)
    assert graph.processes["fails"].wait(LIMIT_S)
    with pytest.raises(GraphFailedError):
        graph.check(starting=True)


def test_an_executable_that_is_missing_fails_the_graph(tmp_path: Path) -> None:
    graph = supervisor(tmp_path, [], {}, node("nothing"))
    with pytest.raises(GraphFailedError, match="nothing cannot be started"):
        graph.start(1)
    assert graph.end() == {"nothing": None}


def test_nodes_that_share_a_process_are_hosted_by_node_group() -> None:
    shared = ProcessPlan("both", (node("one"), node("two")))
    command = command_of(shared, lambda package, executable: f"{package}/{executable}")
    assert command == ["tracked_bringup/node_group", "a_package.nodes.one:Node", "a_package.nodes.two:Node"]
    assert command_of(ProcessPlan("one", (node("one"),)), lambda *names: "/".join(names)) == ["a_package/one"]


def test_children_get_the_domain_of_their_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_DOMAIN_ID", "3")
    monkeypatch.delenv("ROS_AUTOMATIC_DISCOVERY_RANGE", raising=False)
    environment = child_environment(44, tmp_path)
    assert environment["ROS_DOMAIN_ID"] == "44"
    assert environment["ROS_AUTOMATIC_DISCOVERY_RANGE"] == "LOCALHOST"
    assert environment["ROS_LOG_DIR"].startswith(str(tmp_path))


def test_a_stop_request_ends_waiting() -> None:
    stop = StopRequest()
    assert not stop.wait(0.0) and not stop.is_set
    stop.set()
    assert stop.wait(LIMIT_S) and stop.is_set
