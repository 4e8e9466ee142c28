import io
from dataclasses import dataclass, field
from typing import Any

import pytest

from tracked_bringup.console import Console
from tracked_bringup.graph_plan import GraphPlan, NodePlan, ProcessPlan
from tracked_bringup.live_state import LiveState
from tracked_bringup.node_table import NodeEntry
from tracked_bringup.supervisor import GraphFailedError, StopRequest
from tracked_bringup.variant_run import ExitCode, RunEndedError, RunSettings, VariantRun
from tracked_report.scenario import Fault
from tracked_types import GoalReached


def plan(*names: str) -> GraphPlan:
    def process(name: str) -> ProcessPlan:
        entry = NodeEntry.model_validate(
            {"package": "a", "executable": name, "class": f"a.nodes.{name}:Node", "group": name}
        )
        return ProcessPlan(name, (NodePlan(name, entry, {}),))

    return GraphPlan(tuple(process(name) for name in names))


@dataclass
class Graph:
    """Plays supervisor, monitor and clock: one poll is 0.1 s of wall and ``pace`` s of simulated time."""

    plan: GraphPlan
    pace: float = 0.1
    polls_until_up: int = 3
    polls_until_heard: int = 3
    stands_from_s: float = 1e9
    goal_at_s: float = 1e9
    fails_at_s: float = 1e9
    refuses_to_play: str | None = None
    refuses_faults: str | None = None
    wall_s: float = 0.0
    time_s: float = 0.0
    log: list[str] = field(default_factory=list)
    state: LiveState = field(default_factory=LiveState)
    orders: tuple[int, ...] = (1,)
    others: tuple[str, ...] = ()
    codes: dict[str, int | None] = field(default_factory=dict)

    def clock(self) -> float:
        return self.wall_s

    def start(self, order: int) -> list[ProcessPlan]:
        self.log.append(f"start {order}")
        return list(self.plan.processes)

    def check(self, *, starting: bool = False) -> None:
        if self.time_s >= self.fails_at_s:
            raise GraphFailedError("a node ended (exit code 7)")

    def end(self, first: tuple[str, ...] = ()) -> dict[str, int | None]:
        self.log.append(f"end, {' '.join(first)} first")
        return self.codes

    def missing(self, nodes: tuple[NodePlan, ...]) -> list[str]:
        self.polls_until_up -= 1
        return ["ekf (odom)"] if self.polls_until_up > 0 else []

    def unconnected(self) -> list[str]:
        self.polls_until_heard -= 1
        return ["lower_nmpc (hears no odom)"] if self.polls_until_heard > 0 else []

    def doubles(self) -> list[str]:
        return list(self.others)

    def set_playing(self) -> str | None:
        self.log.append("play")
        return self.refuses_to_play

    def inject(self, fault: Fault) -> str | None:
        self.log.append(f"{fault.kind} for {fault.at_s:.1f} at {self.time_s:.1f}")
        return self.refuses_faults

    def refresh(self) -> LiveState:
        if self.time_s < self.stands_from_s:
            self.time_s += self.pace
        self.state.note_time(round(self.time_s * 1e9))
        if self.time_s >= self.goal_at_s and self.state.goal is None:
            self.state.note_goal(GoalReached(round(self.time_s * 1e9), "line", 0.01, 0.0))
        return self.state


class Ticks(StopRequest):
    """Waiting moves the graph's wall clock instead of the real one; stops after so many waits."""

    def __init__(self, graph: Graph, stop_after: int = 10**9) -> None:
        super().__init__()
        self.graph = graph
        self.left = stop_after

    def wait(self, timeout_s: float) -> bool:
        self.graph.wall_s += 0.1
        self.left -= 1
        return self.left < 0


def run(graph: Graph, stop_after: int = 10**9, **settings: Any) -> LiveState:
    console = Console(io.StringIO())
    chosen = RunSettings(**{"label": "double", "duration_s": 5.0, **settings})
    return VariantRun(
        graph.plan,
        graph,  # type: ignore[arg-type]
        graph,
        chosen,
        console,
        Ticks(graph, stop_after),
        graph.clock,
    ).run()


def test_time_starts_when_every_endpoint_is_there_and_everything_is_ended_the_recorder_first() -> None:
    graph = Graph(plan("sim_bridge", "ekf"))
    assert run(graph).time_s >= 5.0
    assert graph.log == ["start 1", "play", "end, recorder mcap_recorder first"]
    assert graph.polls_until_up == 0 and graph.polls_until_heard == 0


def test_without_a_simulator_nobody_starts_the_time() -> None:
    graph = Graph(plan("ekf"))
    run(graph)
    assert "play" not in graph.log


def test_the_run_ends_soon_after_the_goal() -> None:
    state = run(Graph(plan("sim_bridge"), goal_at_s=2.0))
    assert 3.0 <= state.time_s < 3.3


def test_a_goal_may_be_driven_past() -> None:
    assert run(Graph(plan("sim_bridge"), goal_at_s=2.0), stop_at_goal=False).time_s >= 5.0


@pytest.mark.parametrize(
    ("trouble", "code", "words"),
    [
        ({"polls_until_up": 10**6}, ExitCode.NOT_MATCHED, r"no endpoints after 30 s: ekf \(odom\)"),
        (
            {"polls_until_heard": 10**6},
            ExitCode.NOT_MATCHED,
            r"no connections after 10 s: lower_nmpc \(hears no odom\)",
        ),
        ({"others": ("there is another /ekf",)}, ExitCode.NOT_MATCHED, "another /ekf in this domain"),
        ({"refuses_to_play": "no service"}, ExitCode.NOT_MATCHED, "cannot be started: no service"),
        ({"stands_from_s": 2.0}, ExitCode.STALLED, "time stands still at 2.0"),
        ({"fails_at_s": 1.0}, ExitCode.NODE_FAILED, "a node ended"),
    ],
)
def test_a_bad_end_has_its_code_and_reason_and_leaves_nothing_running(
    trouble: dict[str, Any], code: ExitCode, words: str
) -> None:
    graph = Graph(plan("sim_bridge"), **trouble)
    with pytest.raises(RunEndedError, match=words) as error:
        run(graph)
    assert error.value.code is code
    assert graph.log[-1] == "end, recorder mcap_recorder first"


@pytest.mark.parametrize("stop_after", [1, 20])
def test_an_interruption_ends_everything(stop_after: int) -> None:
    graph = Graph(plan("sim_bridge"))
    with pytest.raises(RunEndedError, match="interrupted") as error:
        run(graph, stop_after)
    assert error.value.code is ExitCode.INTERRUPTED and graph.log[-1] == "end, recorder mcap_recorder first"


def test_an_open_ended_run_ends_well_when_asked_to() -> None:
    assert run(Graph(plan("sim_bridge")), 20, open_ended=True).time_s > 0.0


def test_faults_are_announced_before_time_starts() -> None:
    graph = Graph(plan("sim_bridge"))
    faults = (
        Fault(at_s=3.0, kind="freeze", target="tracks"),
        Fault(at_s=1.0, kind="bias", target="imu", value=0.1),
    )
    run(graph, faults=faults)
    assert graph.log[1:4] == ["freeze for 3.0 at 0.0", "bias for 1.0 at 0.0", "play"]


@pytest.mark.parametrize(
    ("nodes", "words"),
    [(("sim_bridge",), "fault freeze of nose is refused: no such sensor"), (("ekf",), "sim_bridge, which does not")],
)
def test_faults_that_cannot_be_injected_end_the_run_as_a_bad_argument(nodes: tuple[str, ...], words: str) -> None:
    graph = Graph(plan(*nodes), refuses_faults="no such sensor")
    with pytest.raises(RunEndedError, match=words) as error:
        run(graph, faults=(Fault(at_s=1.0, kind="freeze", target="nose"),))
    assert error.value.code is ExitCode.BAD_ARGUMENTS
    assert "play" not in graph.log
