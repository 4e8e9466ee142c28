"""A real executable in a process of its own, started through ``./run``."""

import contextlib
import os
import signal
import subprocess
from collections.abc import Mapping
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
END_LIMIT_S = 15.0


class NodeProcess:
    """Starts an executable, keeps its output in a file, and ends it with everything it started.

    stdin: file number that it reads from; nothing by default.
    """

    def __init__(
        self, arguments: tuple[str, ...], log: Path, environment: Mapping[str, str], stdin: int = subprocess.DEVNULL
    ) -> None:
        self.arguments = arguments
        self._log = log
        with log.open("wb") as sink:
            self._process = subprocess.Popen(
                [str(ROOT / "run"), *arguments],
                stdin=stdin,
                stdout=sink,
                stderr=subprocess.STDOUT,
                env={**os.environ, **environment},
                start_new_session=True,
            )

    @property
    def pid(self) -> int:
        """Process id of the executable itself: ``./run`` turns into it."""
        return self._process.pid

    @property
    def output(self) -> str:
        """What it has written so far."""
        return self._log.read_text(errors="replace")

    @property
    def is_running(self) -> bool:
        """True until it has ended."""
        return self._process.poll() is None

    def send(self, number: signal.Signals) -> None:
        """Signal the executable."""
        self._process.send_signal(number)

    def wait(self, timeout_s: float = END_LIMIT_S) -> int:
        """Its exit code, negative for a signal as in subprocess.

        Raises:
            AssertionError: it is still running; with its output.
        """
        try:
            return self._process.wait(timeout_s)
        except subprocess.TimeoutExpired as error:
            raise AssertionError(f"{self.arguments} still runs after {timeout_s} s:\n{self.output[-4000:]}") from error

    def ends_within(self, timeout_s: float) -> bool:
        """Whether it has ended, after waiting for that at most so long."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(timeout_s)
        return not self.is_running

    def stop(self, number: signal.Signals = signal.SIGINT) -> int:
        """Signal it and return its exit code."""
        if self.is_running:
            self.send(number)
        return self.wait()

    def end(self) -> None:
        """Make sure that nothing of it is left, politely first."""
        with contextlib.suppress(AssertionError):
            self.stop()
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.pid, signal.SIGKILL)
        self._process.wait()
