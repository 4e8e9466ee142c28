"""One run of the demo's step scenario with both layers in lock-step: what was on the topics, what was recorded."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rclpy.topic_endpoint_info import TopicEndpointInfo

from tests.support.contract import CONTRACT
from tests.support.graph_process import GraphProcess
from tests.support.listener import own_listener
from tracked_report.run_record import RunRecord

SCENARIO, VARIANT = "compare", "double"
LIMIT_S = 110.0
LOOK_EVERY_S = 0.2


@dataclass(frozen=True, slots=True)
class Endpoints:
    """Publishers and subscribers of every topic of the contract while time ran, by topic."""

    publishers: dict[str, list[TopicEndpointInfo]]
    subscribers: dict[str, list[TopicEndpointInfo]]


@dataclass(frozen=True, slots=True)
class StepRun:
    """What one run left."""

    messages: dict[str, list[Any]]
    endpoints: Endpoints
    exit_code: int
    output: str
    record: RunRecord


def drive_over_the_step(domain: int, folder: Path) -> StepRun:
    """Run the graph to its end and listen all the while."""
    with own_listener(domain) as listener:
        for row in CONTRACT:
            listener.hear(row.type, row.topic, latched=row.latched)
        graph = GraphProcess(domain, folder, SCENARIO, "--variant", VARIANT, "--name", "step")
        endpoints = Endpoints({}, {})
        try:
            while not graph.ends_within(LOOK_EVERY_S):
                listener.refresh()
                if not endpoints.publishers and len(listener.messages["cmd_vel"]) > 10:
                    endpoints = Endpoints(
                        {row.topic: listener.publishers(row.topic) for row in CONTRACT},
                        {row.topic: listener.subscribers(row.topic) for row in CONTRACT},
                    )
            listener.refresh()
        finally:
            graph.end()
        assert graph.wait() == 0, graph.output
        record = RunRecord.load(graph.folder / "step" / f"{VARIANT}.npz")
        return StepRun(listener.messages, endpoints, graph.wait(), graph.output, record)
