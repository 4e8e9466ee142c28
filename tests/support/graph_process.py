"""A whole graph, started as a user starts it, with its processes in reach."""

import contextlib
import os
import signal
from pathlib import Path

from tests.support.node_process import NodeProcess


class GraphProcess(NodeProcess):
    """``./run bringup ARGUMENTS`` in a domain; records, logs and reports go below ``folder``."""

    def __init__(self, domain: int, folder: Path, *arguments: str) -> None:
        self.folder = folder / "out"
        environment = {"ROS_DOMAIN_ID": str(domain), "TRACKED_OUT": str(self.folder)}
        super().__init__(("bringup", *arguments), folder / "bringup.log", environment)

    @property
    def children(self) -> dict[str, int]:
        """Name of each process, which is that of its parameter file, and its process id."""
        found = {}
        for task in Path(f"/proc/{self.pid}/task").glob("*/children"):
            for child in task.read_text().split():
                words = Path(f"/proc/{child}/cmdline").read_text().split("\0")
                found.update({Path(word).stem: int(child) for word in words if word.endswith(".yaml")})
        return found

    def signal_child(self, name: str, number: signal.Signals) -> int:
        """Signal one process of the graph; its process id."""
        pid = self.children[name]
        os.kill(pid, number)
        return pid

    def logs(self, run: str, variant: str = "double") -> str:
        """What all processes of a variant have written."""
        return "\n".join(
            log.read_text(errors="replace") for log in (self.folder / run / "logs" / variant).glob("*.log")
        )

    def left_behind(self) -> list[int]:
        """Processes that still use a parameter file of this graph."""
        found = []
        for command in Path("/proc").glob("[0-9]*/cmdline"):
            with contextlib.suppress(OSError):
                if str(self.folder) in command.read_text(errors="replace") and int(command.parent.name) != self.pid:
                    found.append(int(command.parent.name))
        return found
