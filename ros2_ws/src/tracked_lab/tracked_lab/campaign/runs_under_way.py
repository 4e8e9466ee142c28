"""Runs that have been handed to the workers of a dask scheduler, and what comes back of each."""

import contextlib
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from distributed import Client, Status, wait
from distributed.client import ClosedClientError
from distributed.scheduler import KilledWorker

from tracked_lab.campaign.perform import Measure, perform
from tracked_lab.campaign.run_inputs import RunInputs
from tracked_lab.campaign.run_store import StoredRun

_PER_WORKER = 4  # runs that are handed out ahead
_STUCK_GRACE_S = 15.0
_LONGEST_LOOK_S = 2.0
_OVER = (Status.closed, Status.failed)


class SchedulerError(RuntimeError):
    """No scheduler can be reached, or not any more; one sentence."""


@dataclass(frozen=True, slots=True)
class Plan:
    """What is to be done of a campaign: runs that the store does not have yet."""

    campaign: str
    inputs: Sequence[RunInputs]
    limit_s: float


class RunsUnderWay:
    """Keeps every worker busy with a few runs ahead, so that the work per run does not grow with their number."""

    def __init__(self, plan: Plan, client: Client, measure: Measure) -> None:
        self._plan, self._client, self._measure = plan, client, measure
        self._waiting = iter(plan.inputs)
        self._handed: dict[Any, RunInputs] = {}
        self._at_work_s: dict[str, float] = {}
        self._looked_s = time.monotonic()
        with _scheduler_there(client):
            self._hand_out()

    @property
    def any(self) -> bool:
        """Whether there is anything to wait for."""
        return bool(self._handed)

    def ended(self) -> list[StoredRun]:
        """Wait a second at most for runs to end; their rows.

        Raises
        ------
        SchedulerError: if the scheduler is gone; what was under way is not known then, and is no row.
        """
        with _scheduler_there(self._client):
            with contextlib.suppress(TimeoutError):
                wait(list(self._handed), timeout=1.0, return_when="FIRST_COMPLETED")
            done = [future for future in self._handed if future.done()]
            rows = [self._row(future, self._handed.pop(future)) for future in done]
            for future in self._ended_by_force():
                planned = self._handed.pop(future)
                rows.append(self._failure(planned, "timeout", "stuck in a call; its worker was ended"))
            self._restore_workers()
            self._hand_out()
        return rows

    def _restore_workers(self) -> None:
        """Replace local workers whose nanny gave them up, as it does if one dies while it starts.

        Workers of somebody else's scheduler are not ours to start.
        """
        cluster = self._client.cluster
        if cluster is None:
            return
        given_up = [name for name, nanny in cluster.workers.items() if nanny.status in _OVER]
        for name in given_up:
            del cluster.workers[name]
        if given_up:
            cluster.scale(len(cluster.worker_spec))

    def _hand_out(self) -> None:
        workers = max(len(self._client.scheduler_info(n_workers=-1)["workers"]), 1)
        for _, planned in zip(range(_PER_WORKER * workers - len(self._handed)), self._waiting, strict=False):
            inputs = planned.model_dump_json()
            future = self._client.submit(
                perform, inputs, self._plan.campaign, self._plan.limit_s, self._measure, pure=False
            )
            self._handed[future] = planned

    def _row(self, future: Any, planned: RunInputs) -> StoredRun:
        try:
            found: StoredRun = future.result()
        except CancelledError:
            raise  # by a scheduler that went away: not this run's doing
        except KilledWorker as error:
            return self._failure(planned, "failed", f"took its worker down again and again: {error}")
        except Exception as error:
            text = f"{type(error).__name__}: {error}"
            if isinstance(error, ImportError) or "deserializ" in text:
                raise SchedulerError(
                    f"the workers cannot run this code, start them in its environment ({text:.200})"
                ) from error
            return self._failure(planned, "failed", text)
        return found

    def _failure(self, planned: RunInputs, status: str, error: str) -> StoredRun:
        inputs, seed = planned.model_dump_json(), planned.scenario.seed
        return StoredRun(planned.key, self._plan.campaign, planned.way, seed, planned.cell, inputs, status, error)

    def _ended_by_force(self) -> list[Any]:
        """Runs that outlast their limit because a call does not come back; their workers are ended."""
        now_s = time.monotonic()
        # A campaign that was stopped and continued as a whole has not waited for anybody meanwhile.
        since_s, self._looked_s = min(now_s - self._looked_s, _LONGEST_LOOK_S), now_s
        at_work = {keys[0]: worker for worker, keys in self._client.processing().items() if keys}
        self._at_work_s = {key: self._at_work_s.get(key, -since_s) + since_s for key in at_work}
        limit_s = self._plan.limit_s + _STUCK_GRACE_S
        stuck = [future for future in self._handed if self._at_work_s.get(future.key, 0.0) > limit_s]
        for future in stuck:
            future.cancel(force=True)
            self._client.restart_workers([at_work[future.key]], timeout=30, raise_for_error=False)
        return stuck


@contextmanager
def _scheduler_there(client: Client) -> Iterator[None]:
    """Say in one sentence that the scheduler is gone, whatever dask says then."""
    lost = "the scheduler is gone; what was done is kept, the same command goes on from there"
    try:
        yield
    except (CancelledError, ClosedClientError, OSError) as error:
        raise SchedulerError(lost) from error
    if client.status != "running":
        raise SchedulerError(lost)
