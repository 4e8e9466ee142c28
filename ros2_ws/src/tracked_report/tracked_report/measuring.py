"""Runs the commands behind the claims and reads their figures back."""

import os
import shlex
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from tracked_report.ledger import Measurement
from tracked_report.machine import UNKNOWN
from tracked_report.results import OUT_VARIABLE, MetricsError, read_metrics

OUT = Path("out")
QUICK_OUT = OUT / "quick"
LOGS = "claims_logs"


@dataclass(frozen=True, slots=True)
class Measured:
    """Outcome of one command. ``failure`` is empty when its figures are fresh and readable."""

    command: str
    seconds: float
    values: dict[str, float | None] = field(default_factory=dict)
    commit: str = UNKNOWN
    failure: str = ""


def measure(
    name: str,
    measurement: Measurement,
    root: Path,
    *,
    quick: bool = False,
    tick: Callable[[], None] = lambda: None,
    cancel: threading.Event | None = None,
) -> Measured:
    """Run one command in ``root`` and read the metrics file it must have written anew.

    ``python`` in a command is the interpreter that runs this. Output goes to ``out/claims_logs/<name>.log``;
    ``tick`` is called about twice a second; ``cancel``, once set, ends the command. Nothing that a command does
    raises: one that fails, runs too long or leaves no fresh figures is told in ``failure``.
    """
    command = (measurement.quick or "") if quick else measurement.run
    metrics = root / (QUICK_OUT / Path(measurement.metrics).relative_to(OUT) if quick else measurement.metrics)
    log = root / (QUICK_OUT if quick else OUT) / LOGS / f"{name}.log"
    before = _version(metrics)
    started = time.monotonic()

    def trouble() -> str:
        tick()
        if cancel is not None and cancel.is_set():
            return "interrupted"
        late = time.monotonic() - started > measurement.timeout_s
        return f"ran longer than {measurement.timeout_s:g} s" if late else ""

    failure = _run(command, root, log, quick, trouble)
    seconds = time.monotonic() - started
    if failure:
        return Measured(command, seconds, failure=failure)
    if _version(metrics) in (None, before):
        return Measured(command, seconds, failure=f"the command wrote no new {metrics.relative_to(root)}")
    try:
        figures = read_metrics(metrics)
    except MetricsError as error:
        return Measured(command, seconds, failure=str(error))
    return Measured(command, seconds, figures.values, figures.commit)


def _run(command: str, root: Path, log: Path, quick: bool, trouble: Callable[[], str]) -> str:
    """Run to the end, or until there is ``trouble``; what went wrong, in words, or nothing."""
    environment = dict(os.environ)
    environment["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), environment.get("PATH", os.defpath)])
    if quick:
        environment[OUT_VARIABLE] = str(QUICK_OUT)
    try:
        log.parent.mkdir(parents=True, exist_ok=True)
        with log.open("wb") as output:
            process = subprocess.Popen(
                shlex.split(command),
                cwd=root,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
            try:
                failure = _wait(process, trouble)
            finally:
                _stop_group(process)
        return f"{failure}: {_last_line(log)}" if failure else ""
    except (OSError, ValueError) as error:
        return f"cannot run ({error})"


def _wait(process: "subprocess.Popen[bytes]", trouble: Callable[[], str]) -> str:
    while not (failure := trouble()):
        try:
            code = process.wait(timeout=0.5)
        except subprocess.TimeoutExpired:
            continue
        return f"exit code {code}" if code else ""
    return failure


def _stop_group(process: "subprocess.Popen[bytes]") -> None:
    """End the command with everything it started; of one that has ended, what it left behind."""
    for number in (signal.SIGTERM, signal.SIGKILL):
        try:
            os.killpg(process.pid, number)
            process.wait(timeout=5.0)
        except subprocess.TimeoutExpired:
            continue
        except (ProcessLookupError, PermissionError):
            return


def _version(path: Path) -> tuple[int, int] | None:
    """Something that changes whenever a file is written whole anew; None if there is none."""
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_mtime_ns, status.st_ino


def _last_line(log: Path) -> str:
    lines = [line.strip() for line in log.read_text(encoding="utf-8", errors="replace").splitlines() if line.strip()]
    return lines[-1][-200:] if lines else "no output"
