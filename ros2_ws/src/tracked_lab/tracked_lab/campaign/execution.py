"""Runs the runs of a campaign on the workers of a dask scheduler, local ones or a cluster's."""

import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import dask
from distributed import Client, LocalCluster

from tracked_lab.campaign.perform import Measure, perform
from tracked_lab.campaign.run_inputs import RunInputs
from tracked_lab.campaign.run_store import RunStore, StoredRun
from tracked_lab.campaign.runs_under_way import Plan, RunsUnderWay, SchedulerError

_SAVE_EVERY_S = 1.0
_CONNECT_S = 10.0
# A worker holds one run: if it dies, only that run is suspected, and it is given up after taking three down.
# The cluster must not give up a worker that died: it looks once, and ends one that is starting again just then.
_LOCAL = {
    "distributed.scheduler.worker-saturation": 1.0,
    "distributed.scheduler.allowed-failures": 2,
    "distributed.deploy.lost-worker-timeout": "365 days",
}
_LOADED = [perform.__module__]  # before a worker counts as there: loading takes seconds, which are no run's time
Told = Callable[[StoredRun], None]


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
            preload=_LOADED,
        ) as cluster,
        Client(cluster) as client,
    ):
        yield client


def execute(plan: Plan, store: RunStore, client: Client, told: Told, measure: Measure = RunInputs.figures) -> None:
    """Do all runs of the plan; each is in the store within about a second of its end.

    A run that raises or takes too long is a row like any other. ``told`` hears of every run that ended.

    Raises
    ------
    SchedulerError: if the scheduler goes away; what was under way is done by the next call.
    StoreError: if results cannot be written.
    """
    ended: list[StoredRun] = []
    saved_s = time.monotonic()
    try:
        under_way = RunsUnderWay(plan, client, measure)
        while under_way.any:
            for run in under_way.ended():
                ended.append(run)
                told(run)
            if ended and time.monotonic() - saved_s > _SAVE_EVERY_S:
                store.add(ended)
                ended, saved_s = [], time.monotonic()
    finally:
        store.add(ended)
