"""Runs the runs of a campaign on the workers of a dask scheduler, local ones or a cluster's."""

import contextlib
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import dask
from distributed import Client, LocalCluster, wait
from distributed.scheduler import KilledWorker

from tracked_lab.campaign.perform import Measure, perform
from tracked_lab.campaign.run_inputs import RunInputs
from tracked_lab.campaign.run_store import RunStore, StoredRun

_IN_FLIGHT = 4  # runs per worker that are handed out ahead
_STUCK_GRACE_S = 15.0
_SAVE_EVERY_S = 1.0
_CONNECT_S = 10.0
# A worker that dies is one run's doing: no other is with it, and that run is not tried more than twice.
_LOCAL = {"distributed.scheduler.worker-saturation": 1.0, "distributed.scheduler.allowed-failures": 1}
Told = Callable[[StoredRun], None]
Running = dict[Any, RunInputs]
"""Futures of the runs that have been handed out."""


class SchedulerError(RuntimeError):
    """No scheduler can be reached; one sentence."""


@dataclass(frozen=True, slots=True)
class Plan:
    """What is to be done of a campaign: runs that the store does not have yet."""

    campaign: str
    inputs: Sequence[RunInputs]
    limit_s: float


def missing(inputs: Sequence[RunInputs], store: RunStore, *, again: bool = False) -> list[RunInputs]:
    """Runs that the store has no figures of, each key once; ``again``: also those that failed before."""
    known = {key for key, run in store.runs().items() if run.ok or not again}
    found: dict[str, RunInputs] = {}
    for planned in inputs:
        key = planned.key
        if key not in known:
            found.setdefault(key, planned)
    return list(found.values())


@contextmanager
def connected(scheduler: str | None, workers: int) -> Iterator[Client]:
    """A client of the scheduler at this address, or of one of our own with local worker processes.

    Raises
    ------
    SchedulerError: if the address is unreachable or means nothing.
    """
    if scheduler is not None:
        try:
            client = Client(scheduler, timeout=_CONNECT_S)
        except (OSError, ValueError, TypeError) as error:
            raise SchedulerError(f"the scheduler {scheduler} cannot be reached ({type(error).__name__})") from error
        with client:
            yield client
        return
    with (
        dask.config.set(_LOCAL),
        tempfile.TemporaryDirectory(prefix="campaign-") as folder,
        LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            dashboard_address="127.0.0.1:0",
            local_directory=folder,
            silence_logs=50,
        ) as cluster,
        Client(cluster) as client,
    ):
        yield client


def execute(plan: Plan, store: RunStore, client: Client, told: Told, measure: Measure = RunInputs.figures) -> None:
    """Do all runs of the plan; each is in the store within about a second of its end.

    A run that raises or takes too long is a row like any other. ``told`` hears of every run that ended.
    """
    waiting = iter(plan.inputs)
    under_way: Running = {}
    begun_s: dict[str, float] = {}
    ended: list[StoredRun] = []
    saved_s = time.monotonic()

    def hand_out() -> None:
        room = _IN_FLIGHT * max(len(client.scheduler_info(n_workers=-1)["workers"]), 1) - len(under_way)
        for _, planned in zip(range(room), waiting, strict=False):
            future = client.submit(perform, planned.model_dump_json(), plan.campaign, plan.limit_s, measure, pure=False)
            under_way[future] = planned

    hand_out()
    try:
        while under_way:
            with contextlib.suppress(TimeoutError):
                wait(list(under_way), timeout=1.0, return_when="FIRST_COMPLETED")
            for future in [future for future in under_way if future.done()]:
                planned = under_way.pop(future)
                ended.append(_result(future, planned, plan.campaign))
                told(ended[-1])
            for future in _stuck(client, under_way, begun_s, plan.limit_s):
                planned = under_way.pop(future)
                ended.append(_failure(planned, plan.campaign, "timeout", "stuck in a call; its worker was ended"))
                told(ended[-1])
            if ended and time.monotonic() - saved_s > _SAVE_EVERY_S:
                store.add(ended)
                ended, saved_s = [], time.monotonic()
            hand_out()
    finally:
        store.add(ended)


def _result(future: Any, planned: RunInputs, campaign: str) -> StoredRun:
    try:
        found: StoredRun = future.result()
    except KilledWorker as error:
        return _failure(planned, campaign, "failed", f"took its worker down again and again: {error}")
    except Exception as error:
        return _failure(planned, campaign, "failed", f"{type(error).__name__}: {error}")
    return found


def _failure(planned: RunInputs, campaign: str, status: str, error: str) -> StoredRun:
    inputs = planned.model_dump_json()
    return StoredRun(planned.key, campaign, planned.way, planned.scenario.seed, planned.cell, inputs, status, error)


def _stuck(client: Client, under_way: Running, begun_s: dict[str, float], limit_s: float) -> list[Any]:
    """Runs that outlast their limit because a call does not come back; their workers are ended."""
    now_s, running = time.monotonic(), {}
    for worker, keys in client.processing().items():
        if keys:  # the first is the one at work
            running[keys[0]] = worker
    for key in running:
        begun_s.setdefault(key, now_s)
    for key in [key for key in begun_s if key not in running]:
        del begun_s[key]
    stuck = [key for key, since_s in begun_s.items() if now_s - since_s > limit_s + _STUCK_GRACE_S]
    found = [future for future in under_way if future.key in stuck]
    for future in found:
        future.cancel(force=True)
        client.restart_workers([running[future.key]], timeout=30, raise_for_error=False)
        del begun_s[future.key]
    return found
