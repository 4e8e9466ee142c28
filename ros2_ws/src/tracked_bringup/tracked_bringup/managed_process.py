"""One child process: started in a group of its own, logged line by line, ended for certain."""

import contextlib
import ctypes
import os
import re
import signal
import subprocess
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

_PR_SET_PDEATHSIG = 1
_LIBC = ctypes.CDLL(None, use_errno=True)
_TAIL_LINES = 15
_LOUD = re.compile(r"\[(WARN|ERROR|FATAL)\]|^Traceback|^\w*(Error|Exception)\b")
ESCALATION: tuple[tuple[signal.Signals, float], ...] = (
    (signal.SIGINT, 10.0),
    (signal.SIGTERM, 3.0),
    (signal.SIGKILL, 3.0),
)
"""Signals that end a child, and how long (s) each of them is given."""


class ManagedProcess:
    """A child that ends with this process, whatever way this process ends.

    name: prefix of its lines.
    command: program and arguments.
    log: file that all its output goes to, appended.
    say: called with lines worth the user's attention (warnings, errors), or with all when ``verbose``.
    """

    def __init__(
        self,
        name: str,
        command: Sequence[str],
        environment: Mapping[str, str],
        log: Path,
        say: Callable[[str], None],
        *,
        verbose: bool = False,
    ) -> None:
        self.name = name
        self.starts = 0
        self._command = list(command)
        self._environment = dict(environment)
        self._log = log
        self._say = say
        self._verbose = verbose
        self._tail: deque[str] = deque(maxlen=_TAIL_LINES)
        self._process: subprocess.Popen[bytes] | None = None
        self._reader: threading.Thread | None = None

    def start(self) -> None:
        """Start it, or start it again.

        Raises
        ------
        OSError: if the program cannot be started or the log cannot be written.
        """
        self._log.parent.mkdir(parents=True, exist_ok=True)
        with self._log.open("ab"):  # a full or read-only disk is told here, not in the reading thread
            pass
        parent = os.getpid()
        self._process = subprocess.Popen(
            self._command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            env=self._environment,
            start_new_session=True,
            preexec_fn=lambda: _end_with(parent),
        )
        self.starts += 1
        self._reader = threading.Thread(target=self._read, args=(self._process,), name=f"log of {self.name}")
        self._reader.daemon = True
        self._reader.start()

    @property
    def pid(self) -> int | None:
        """Its process id, once started."""
        return self._process.pid if self._process else None

    @property
    def is_running(self) -> bool:
        """Started and not ended."""
        return self._process is not None and self._process.poll() is None

    @property
    def exit_code(self) -> int | None:
        """Its exit code, negative for a signal; None while it runs."""
        return self._process.poll() if self._process else None

    @property
    def last_words(self) -> str:
        """The last lines it wrote."""
        if self._reader:
            self._reader.join(timeout=1.0)
        return "\n".join(self._tail)

    def send(self, number: signal.Signals) -> None:
        """Signal the process itself; SIGKILL goes to its whole group."""
        if self._process is None:
            return
        with contextlib.suppress(ProcessLookupError):
            if number == signal.SIGKILL:
                os.killpg(self._process.pid, number)
            else:
                self._process.send_signal(number)

    def wait(self, timeout_s: float) -> bool:
        """Whether it has ended within ``timeout_s``."""
        if self._process is None:
            return True
        try:
            self._process.wait(timeout_s)
        except subprocess.TimeoutExpired:
            return False
        return True

    def sweep(self) -> None:
        """End whatever it has left behind in its group, and let its log be complete."""
        self.send(signal.SIGKILL)
        if self._reader:
            self._reader.join(timeout=2.0)

    def _read(self, process: subprocess.Popen[bytes]) -> None:
        assert process.stdout is not None
        with process.stdout as source, self._log.open("ab", buffering=0) as log:
            for raw in source:
                text = raw.decode("utf-8", errors="replace").rstrip()
                self._tail.append(text)
                with contextlib.suppress(OSError):  # a disk that fills up must not stop the robot
                    log.write(raw)
                if self._verbose or _LOUD.search(text):
                    self._say(f"[{self.name}] {text}")


def end_all(
    processes: Sequence[ManagedProcess], escalation: Sequence[tuple[signal.Signals, float]] = ESCALATION
) -> list[str]:
    """End all of them together, ever less politely; the names of those that needed more than the first signal."""
    stubborn: list[str] = []
    for step, (number, limit_s) in enumerate(escalation):
        running = [process for process in processes if process.is_running]
        if not running:
            break
        if step:
            stubborn += [process.name for process in running if process.name not in stubborn]
        for process in running:
            process.send(number)
        deadline_s = time.monotonic() + limit_s
        for process in running:
            process.wait(max(0.0, deadline_s - time.monotonic()))
    for process in processes:
        process.sweep()
    return stubborn


def _end_with(parent: int) -> None:
    """In the child: be told when the parent dies, and do not outlive one that has died already."""
    _LIBC.prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
    if os.getppid() != parent:
        os._exit(1)
