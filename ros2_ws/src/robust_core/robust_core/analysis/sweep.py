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
    header = _header(kinds, family, grid, exact)
    store = _Store.opened(None if file is None else Path(file), header)
    total = len(kinds) * len(grid)

    def report() -> None:
        if progress is not None:
            progress(sum(len(rows) for part in store.done.values() for rows in part), total)

    report()
    jobs = {
        start: (kinds, family, grid[start : start + _CHUNK], exact)
        for start in range(0, len(grid), _CHUNK)
        if start not in store.done
    }
    processes = workers or len(os.sched_getaffinity(0))
    if processes == 1 or len(jobs) <= 1:
        for start, job in jobs.items():
            store.add(start, _work(*job))
            report()
    else:
        _in_parallel(jobs, processes, store, report)
    return _collect(kinds, grid, store.done)


def _in_parallel(jobs: dict[int, Any], processes: int, store: "_Store", report: Callable[[], None]) -> None:
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        running: dict[Future[Any], int] = {pool.submit(_work, *job): start for start, job in jobs.items()}
        try:
            while running:
                finished, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in finished:
                    store.add(running.pop(future), future.result())
                report()
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise


Part = list[list[list[str]]]
"""Verdict and margin of every theorem at every point of a chunk."""


def _work(theorems: Sequence[Theorem], family: Family, points: Floats, exact: bool) -> Part:
    models = family(points)
    return [
        [[result.verdict.value, repr(result.margin)] for result in decide_many(theorem, models, exact=exact)]
        for theorem in theorems
    ]


def _header(theorems: Sequence[Theorem], family: Family, points: Floats, exact: bool) -> str:
    named = getattr(family, "__qualname__", None) or repr(family)
    return digest_of([[t.to_json() for t in theorems], named, [v.hex() for v in points.ravel().tolist()], exact])


@dataclass(frozen=True, slots=True)
class _Store:
    """Results so far by the first point of their chunk, in memory and in the file."""

    path: Path | None
    done: dict[int, Part]

    @staticmethod
    def opened(path: Path | None, header: str) -> "_Store":
        """What the file holds; it is written again, so that a line that was cut off is gone."""
        if path is None:
            return _Store(None, {})
        done = _read(path, header) if path.exists() else {}
        lines = [{"sweep": header}, *({"start": start, "verdicts": part} for start, part in done.items())]
        path.write_text("".join(json.dumps(line) + "\n" for line in lines), encoding="utf-8")
        return _Store(path, done)

    def add(self, start: int, part: Part) -> None:
        """Keep the results of a chunk."""
        self.done[start] = part
        if self.path is not None:
            with self.path.open("a", encoding="utf-8") as stream:
                stream.write(json.dumps({"start": start, "verdicts": part}) + "\n")


def _read(path: Path, header: str) -> dict[int, Part]:
    lines = path.read_text(encoding="utf-8").splitlines()
    done: dict[int, Part] = {}
    for number, line in enumerate(lines):
        try:
            content = json.loads(line)
            if number > 0:
                done[int(content["start"])] = content["verdicts"]
        except (ValueError, KeyError, TypeError) as error:
            if number == len(lines) - 1 and number > 0:
                break  # The sweep was interrupted while it wrote this line.
            raise SweepFileError(f"{path}: line {number + 1} is damaged") from error
        if number == 0 and (not isinstance(content, dict) or content.get("sweep") != header):
            raise SweepFileError(f"{path}: was written by another sweep; name another file, or delete it")
    return done


def _collect(theorems: tuple[Theorem, ...], points: Floats, done: dict[int, Part]) -> SweepResult:
    verdicts = np.full((len(theorems), len(points)), Verdict.UNDECIDED, dtype=object)
    margins = np.full(verdicts.shape, np.nan)
    for start, part in done.items():
        for kind, rows in enumerate(part):
            for offset, (verdict, margin) in enumerate(rows):
                verdicts[kind, start + offset] = Verdict(verdict)
                margins[kind, start + offset] = float(margin)
    return SweepResult(theorems, points, verdicts, margins)
