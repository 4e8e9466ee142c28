"""One run of one variant: start the graph, let time go, watch, end it, keep the record."""

import enum
import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Protocol

from tracked_bringup.console import Console
from tracked_bringup.graph_plan import GraphPlan, NodePlan
from tracked_bringup.live_state import LiveState
from tracked_bringup.supervisor import GraphFailedError, StopRequest, Supervisor
from tracked_report.scenario import Fault

START_LIMIT_S = 30.0  # for a process to import what it needs and to make its endpoints
MATCH_LIMIT_S = 10.0  # for endpoints to be connected
STALL_LIMIT_S = 30.0  # without simulated time going on
AFTER_GOAL_S = 1.0
_POLL_S = 0.05
_START_POLL_S = 0.1
_STATUS_EVERY_S = 0.25


class ExitCode(enum.IntEnum):
    """What the bringup says to whoever started it."""

    DONE = 0
    NODE_FAILED = 1
    BAD_ARGUMENTS = 2
    NOT_MATCHED = 3
    STALLED = 4
    NO_REPORT = 5
    INTERRUPTED = 130


class RunEndedError(RuntimeError):
    """A run has come to a bad end."""

    def __init__(self, code: ExitCode, reason: str) -> None:
        super().__init__(reason)
        self.code = code


class Monitor(Protocol):
    """What a run needs to see of its graph."""

    def missing(self, nodes: tuple[NodePlan, ...]) -> list[str]:
        """Endpoints that are not there yet."""
        ...

    def unconnected(self) -> list[str]:
        """Subscriptions that do not hear every publisher yet."""
        ...

    def doubles(self) -> list[str]:
        """Nodes of the plan that are in the graph more than once."""
        ...

    def refresh(self) -> LiveState:
        """State after the newest messages."""
        ...

    def set_playing(self) -> str | None:
        """Let simulated time run; why not, or None."""
        ...

    def inject(self, fault: Fault) -> str | None:
        """Announce a fault, to act from its time on; why not, or None."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSettings:
    """When a run ends. ``duration_s``: simulated. ``open_ended``: being asked to stop is a good end."""

    label: str
    duration_s: float
    open_ended: bool = False
    stop_at_goal: bool = True
    faults: tuple[Fault, ...] = ()
    start_limit_s: float = START_LIMIT_S
    match_limit_s: float = MATCH_LIMIT_S
    stall_limit_s: float = STALL_LIMIT_S


class VariantRun:
    """Drives a supervisor and a monitor from start to end; knows wall time only from ``clock``."""

    def __init__(
        self,
        plan: GraphPlan,
        supervisor: Supervisor,
        monitor: Monitor,
        settings: RunSettings,
        console: Console,
        stop: StopRequest,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._plan = plan
        self._supervisor = supervisor
        self._monitor = monitor
        self._settings = settings
        self._console = console
        self._stop = stop
        self._clock = clock

    def run(self) -> LiveState:
        """The whole run, children ended on every way out; the state at its end.

        Raises
        ------
        RunEndedError: with the exit code and the reason.
        """
        try:
            self._start()
            state = self._watch()
            self._supervisor.check()
        except GraphFailedError as failure:
            raise RunEndedError(ExitCode.NODE_FAILED, str(failure)) from failure
        finally:
            self._console.status("")
            # The recorders first, so that they keep the run and not its end.
            codes = self._supervisor.end(first=("recorder", "mcap_recorder"))
        self._judge(codes)
        return state

    def _start(self) -> None:
        if self._settings.faults and not self._plan.has("sim_bridge"):
            raise RunEndedError(ExitCode.BAD_ARGUMENTS, "faults are injected by sim_bridge, which does not take part")
        for order in self._supervisor.orders:
            started = self._supervisor.start(order)
            nodes = tuple(node for process in started for node in process.nodes)
            self._await(partial(self._monitor.missing, nodes), "endpoints", self._settings.start_limit_s)
        self._await(self._monitor.unconnected, "connections", self._settings.match_limit_s)
        doubles = self._monitor.doubles()
        if doubles:
            raise RunEndedError(
                ExitCode.NOT_MATCHED, f"{'; '.join(doubles)} in this domain; set ROS_DOMAIN_ID or namespace:=NAME"
            )
        for fault in self._settings.faults:
            self._inject(fault)
        if self._plan.has("sim_bridge"):
            refusal = self._monitor.set_playing()
            if refusal:
                raise RunEndedError(ExitCode.NOT_MATCHED, f"simulated time cannot be started: {refusal}")

    def _await(self, lacking: Callable[[], list[str]], what: str, limit_s: float) -> None:
        """Wait until nothing is lacking, at most ``limit_s`` from the newest sign of progress on."""
        missing = lacking()
        progress_s = self._clock()
        while missing:
            names = ", ".join(entry.partition(" ")[0] for entry in missing)
            self._console.status(f"{self._settings.label}  waiting for the {what} of {names}")
            self._supervisor.check(starting=True)
            self._pause(_START_POLL_S)
            before, missing = missing, lacking()
            now_s = self._clock()
            if missing != before:
                progress_s = now_s
            elif now_s - progress_s > limit_s:
                raise RunEndedError(ExitCode.NOT_MATCHED, f"no {what} after {limit_s:g} s: {'; '.join(missing)}")

    def _watch(self) -> LiveState:
        settings = self._settings
        first_s: float | None = None
        newest_s, progress_s, shown_s = -math.inf, self._clock(), -math.inf
        while True:
            state = self._monitor.refresh()
            now_s = self._clock()
            self._supervisor.check()
            if state.stamp_ns is not None:
                first_s = state.time_s if first_s is None else first_s
                if state.time_s != newest_s:
                    newest_s, progress_s = state.time_s, now_s
            elapsed_s = 0.0 if first_s is None else state.time_s - first_s
            if self._is_over(state, elapsed_s):
                return state
            if now_s - progress_s > settings.stall_limit_s:
                raise RunEndedError(ExitCode.STALLED, f"time stands still at {state.time_s:.2f} s")
            if now_s - shown_s >= _STATUS_EVERY_S:
                shown_s = now_s
                self._console.status(state.line(settings.label, now_s, settings.duration_s))
            if self._stop.wait(_POLL_S):
                if settings.open_ended:
                    return state
                raise RunEndedError(ExitCode.INTERRUPTED, f"interrupted at {state.time_s:.1f} s")

    def _is_over(self, state: LiveState, elapsed_s: float) -> bool:
        if elapsed_s >= self._settings.duration_s:
            return True
        if state.goal is None or not self._settings.stop_at_goal:
            return False
        return state.time_s >= state.goal.stamp_ns * 1e-9 + AFTER_GOAL_S

    def _inject(self, fault: Fault) -> None:
        """While time still stands, so that a fault begins at its instant in every run."""
        name = f"fault {fault.kind} of {fault.target}"
        refusal = self._monitor.inject(fault)
        if refusal:
            raise RunEndedError(ExitCode.BAD_ARGUMENTS, f"{name} is refused: {refusal}")
        self._console.say(f"{name} from {fault.at_s:g} s on")

    def _pause(self, seconds: float) -> None:
        if self._stop.wait(seconds):
            raise RunEndedError(ExitCode.INTERRUPTED, "interrupted while starting")

    def _judge(self, codes: Mapping[str, int | None]) -> None:
        """A child that was asked to end and did so with an error is worth knowing."""
        for name, code in codes.items():
            if code not in (0, None):
                self._console.say(f"[{name}] ended with an error when asked to end ({code})", "yellow")
