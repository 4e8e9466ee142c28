"""One run in a worker: its figures, or what went wrong; nothing that a run does takes the worker down."""

import ctypes
import threading
import time
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from datetime import UTC, datetime

from tracked_lab.campaign.run_inputs import RunInputs
from tracked_lab.campaign.run_store import StoredRun
from tracked_report.machine import git_commit

_LONGEST_WAIT_S = 0.5
Measure = Callable[[RunInputs], Mapping[str, float]]


class TimeUp(BaseException):
    """The run has had its time; not an Exception, so that no handler on the way keeps it."""


def perform(inputs: str, campaign: str, limit_s: float, measure: Measure = RunInputs.figures) -> StoredRun:
    """Run what the JSON ``inputs`` say and return the row for the store; a run beyond ``limit_s`` is a timeout."""
    planned = RunInputs.model_validate_json(inputs)
    began_s, began_cpu_s = time.monotonic(), time.thread_time()
    status, error, values = "ok", "", {}
    try:
        with _time_limit(limit_s):
            values = {name: float(value) for name, value in measure(planned).items()}
    except TimeUp:
        status, error = "timeout", f"not done after {limit_s:g} s\n{traceback.format_exc()}"
    except Exception:
        status, error = "failed", traceback.format_exc()
    return StoredRun(
        key=planned.key,
        campaign=campaign,
        way=planned.way,
        seed=planned.scenario.seed,
        cell=planned.cell,
        inputs=inputs,
        status=status,
        error=error,
        values=values,
        wall_s=time.monotonic() - began_s,
        cpu_s=time.thread_time() - began_cpu_s,
        commit=git_commit(),
        created=datetime.now(UTC).isoformat(timespec="seconds"),
    )


@contextmanager
def _time_limit(limit_s: float) -> Iterator[None]:
    """Raise TimeUp in this thread once the block has lasted so long; a call that never comes back is not stopped.

    Time over which the whole process is stopped does not count.
    """
    here, done = threading.get_ident(), threading.Event()

    def watch() -> None:
        left_s = limit_s
        while left_s > 0.0:
            if done.wait(min(left_s, _LONGEST_WAIT_S)):
                return
            left_s -= _LONGEST_WAIT_S
        if not done.is_set():
            ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(here), ctypes.py_object(TimeUp))

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        done.set()
        watcher.join()
