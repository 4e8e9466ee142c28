"""Starts the processes of a graph, watches them and ends them."""

import os
import threading
from collections.abc import Callable, Mapping
from pathlib import Path

from tracked_bringup.graph_plan import GraphPlan, ProcessPlan
from tracked_bringup.managed_process import ManagedProcess, end_all

Locate = Callable[[str, str], str]
"""Path of an executable, from package and name."""


class GraphFailedError(RuntimeError):
    """A process that the run depends on has ended or cannot be started."""


class Supervisor:
    """The processes of one run.

    locate: finds executables; logs: folder of one log and one parameter file per process.
    say: takes lines for the user.
    """

    def __init__(
        self,
        plan: GraphPlan,
        *,
        locate: Locate,
        logs: Path,
        environment: Mapping[str, str],
        say: Callable[[str], None],
        verbose: bool = False,
    ) -> None:
        self._plan = plan
        self._say = say
        self.processes: dict[str, ManagedProcess] = {}
        for process in plan.processes:
            parameters = logs / f"{process.name}.yaml"
            logs.mkdir(parents=True, exist_ok=True)
            parameters.write_text(plan.parameter_file(process), encoding="utf-8")
            self.processes[process.name] = ManagedProcess(
                process.name,
                [*command_of(process, locate), "--ros-args", *plan.ros_arguments(parameters)],
                environment,
                logs / f"{process.name}.log",
                say,
                verbose=verbose,
            )

    def start(self, order: int) -> list[ProcessPlan]:
        """Start the processes of one order; which these are.

        Raises
        ------
        GraphFailedError: if one cannot be started.
        """
        due = [process for process in self._plan.processes if process.order == order]
        for process in due:
            try:
                self.processes[process.name].start()
            except OSError as error:
                raise GraphFailedError(f"{process.name} cannot be started: {error}") from error
        return due

    @property
    def orders(self) -> list[int]:
        """Orders that occur, lowest first."""
        return sorted({process.order for process in self._plan.processes})

    def check(self, *, starting: bool = False) -> None:
        """Deal with processes that have ended, by their policy; while ``starting``, none may end.

        Raises
        ------
        GraphFailedError: if the run cannot go on; with the last words of the process.
        """
        for plan in self._plan.processes:
            process = self.processes[plan.name]
            code = process.exit_code
            if code is None:
                continue
            if plan.on_exit == "restart" and process.starts <= plan.restarts and not starting:
                self._say(
                    f"[{plan.name}] ended ({describe_exit(code)}): started again, {process.starts} of {plan.restarts}"
                )
                process.start()
            else:
                words = process.last_words
                raise GraphFailedError(f"{plan.name} ended ({describe_exit(code)})" + (f":\n{words}" if words else ""))

    def end(self, first: tuple[str, ...] = ()) -> dict[str, int | None]:
        """End everything, the processes that host the nodes ``first`` before the others; exit codes by process."""
        early = [process.name for process in self._plan.processes if any(node.name in first for node in process.nodes)]
        for names in (early, [name for name in self.processes if name not in early]):
            for name in end_all([self.processes[name] for name in names if self.processes[name].starts]):
                self._say(f"[{name}] had to be forced to end")
        return {name: process.exit_code for name, process in self.processes.items()}


def command_of(process: ProcessPlan, locate: Locate) -> list[str]:
    """Program and own arguments of a process."""
    if len(process.nodes) == 1:
        entry = process.nodes[0].entry
        return [locate(entry.package, entry.executable)]
    return [locate("tracked_bringup", "node_group"), *(node.entry.node_class for node in process.nodes)]


def describe_exit(code: int) -> str:
    """An exit code in words."""
    return f"exit code {code}" if code >= 0 else f"signal {-code}"


def child_environment(domain: int, logs: Path) -> dict[str, str]:
    """Environment of the nodes: this process's, with domain and log folder, and quiet defaults."""
    environment = dict(os.environ)
    environment |= {"ROS_DOMAIN_ID": str(domain), "ROS_LOG_DIR": str(logs / "ros"), "PYTHONUNBUFFERED": "1"}
    environment.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    environment.setdefault("OMP_NUM_THREADS", "1")
    environment.setdefault("RCUTILS_COLORIZED_OUTPUT", "0")
    return environment


class StopRequest:
    """Set by a signal or by whoever wants the run to end; `wait` returns early then."""

    def __init__(self) -> None:
        self._event = threading.Event()

    def set(self) -> None:
        """Ask for the end."""
        self._event.set()

    @property
    def is_set(self) -> bool:
        """Whether somebody asked."""
        return self._event.is_set()

    def wait(self, timeout_s: float) -> bool:
        """Wait for a request, at most so long; whether there is one."""
        return self._event.wait(timeout_s)
