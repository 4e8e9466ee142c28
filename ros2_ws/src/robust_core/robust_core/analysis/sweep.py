"""Maps over grids: all cores, progress, and a file from which an interrupted sweep goes on."""

import json
import os
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robust_core.analysis.maps import decide_many
from robust_core.checks import finite_array
from robust_core.errors import ArgumentError, RobustCoreError
from robust_core.models.polytope import digest_of
from robust_core.rational import Floats
from robust_core.theorems.base import Theorem
from robust_core.verdict import Verdict

Family = Callable[[Floats], Sequence[Any]]
"""Models for rows of points (N, p). Must be picklable: a module's function, or a frozen dataclass with __call__."""

_CHUNK = 512


class SweepFileError(RobustCoreError):
    """A sweep's file belongs to another sweep, or is damaged."""


@dataclass(frozen=True, slots=True)
class SweepResult:
    """Verdicts (T, N) of T theorems at N points, and the solver's margins (T, N)."""

    theorems: tuple[Theorem, ...]
    points: Floats
    verdicts: NDArray[np.object_]
    margins: Floats

    def count(self, theorem: int, verdict: Verdict) -> int:
        """How many points of a theorem have a verdict."""
        return int((self.verdicts[theorem] == verdict).sum())


def sweep(
    theorems: Sequence[Theorem],
    family: Family,
    points: Any,
    *,
    exact: bool = True,
    workers: int | None = None,
    progress: Callable[[int, int], None] | None = None,
    file: Path | str | None = None,
) -> SweepResult:
    """Ask every theorem at every point.

    Parameters
    ----------
    points: (N, p) parameters.
    workers: processes; None takes all cores that this process may use, 1 stays in this process.
    progress: called with the number of verdicts reached and their total.
    file: verdicts are appended here as they come; a sweep that finds its own file goes on where that ended.

    Raises
    ------
    ArgumentError: for points that are no finite matrix.
    SweepFileError: if the file was written for other theorems or points, or another family.
    """
    grid = np.asarray(finite_array("points", points, (None, None)))
    kinds = tuple(theorems)
    if not kinds:
        raise ArgumentError("theorems", "at least one", "none")
    starts = range(0, len(grid), _CHUNK)
    todo = [(k, start) for start in starts for k in range(len(kinds))]
    header = _header(kinds, family, grid, exact)
    done = {} if file is None else _read(Path(file), header)
    store = _Store(None if file is None else Path(file), header, done)
    total = len(kinds) * len(grid)

    def report() -> None:
        if progress is not None:
            progress(sum(len(rows) for rows in store.done.values()), total)

    report()
    open_tasks = [task for task in todo if f"{task[0]}:{task[1]}" not in store.done]
    jobs = {task: (kinds[task[0]], family, grid[task[1] : task[1] + _CHUNK], exact) for task in open_tasks}
    processes = workers or len(os.sched_getaffinity(0))
    if processes == 1 or len(open_tasks) <= 1:
        for task, job in jobs.items():
            store.add(task, _work(*job))
            report()
    else:
        _in_parallel(jobs, processes, store, report)
    return _collect(kinds, grid, store.done)


def _in_parallel(jobs: dict[Any, Any], processes: int, store: "_Store", report: Callable[[], None]) -> None:
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        running: dict[Future[Any], Any] = {pool.submit(_work, *job): task for task, job in jobs.items()}
        try:
            while running:
                finished, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in finished:
                    store.add(running.pop(future), future.result())
                report()
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise


def _work(theorem: Theorem, family: Family, points: Floats, exact: bool) -> list[list[Any]]:
    results = decide_many(theorem, family(points), exact=exact)
    return [[result.verdict.value, repr(result.margin)] for result in results]


def _header(theorems: Sequence[Theorem], family: Family, points: Floats, exact: bool) -> str:
    named = getattr(family, "__qualname__", None) or repr(family)
    return digest_of([[t.to_json() for t in theorems], named, [v.hex() for v in points.ravel().tolist()], exact])


class _Store:
    """Results so far, in memory and in the file."""

    def __init__(self, path: Path | None, header: str, done: dict[str, list[list[Any]]]) -> None:
        self.path, self.done = path, done
        if path is not None and not done:
            path.write_text(json.dumps({"sweep": header}) + "\n", encoding="utf-8")

    def add(self, task: tuple[int, int], rows: list[list[Any]]) -> None:
        key = f"{task[0]}:{task[1]}"
        self.done[key] = rows
        if self.path is not None:
            with self.path.open("a", encoding="utf-8") as stream:
                stream.write(json.dumps({"part": key, "rows": rows}) + "\n")


def _read(path: Path, header: str) -> dict[str, list[list[Any]]]:
    if not path.exists():
        return {}
    lines = path.read_text(encoding="utf-8").splitlines()
    done: dict[str, list[list[Any]]] = {}
    for number, line in enumerate(lines):
        try:
            content = json.loads(line)
        except ValueError as error:
            if number == len(lines) - 1 and number > 0:
                break  # The sweep was interrupted while it wrote this line.
            raise SweepFileError(f"{path}: line {number + 1} is damaged") from error
        if number == 0:
            if content.get("sweep") != header:
                raise SweepFileError(f"{path}: was written by another sweep; name another file, or delete it")
        else:
            done[content["part"]] = content["rows"]
    return done


def _collect(theorems: tuple[Theorem, ...], points: Floats, done: dict[str, list[list[Any]]]) -> SweepResult:
    verdicts = np.full((len(theorems), len(points)), Verdict.UNDECIDED, dtype=object)
    margins = np.full(verdicts.shape, np.nan)
    for key, rows in done.items():
        kind, start = (int(part) for part in key.split(":"))
        for offset, (verdict, margin) in enumerate(rows):
            verdicts[kind, start + offset] = Verdict(verdict)
            margins[kind, start + offset] = float(margin)
    return SweepResult(theorems, points, verdicts, margins)
