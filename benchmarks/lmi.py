"""LMIs of chapter 2: verdicts and counts on example 2.4.1, their cost against cvxpy, Chua, and soundness.

Times are thread CPU time of this process unless a key says wall. Contenders of one comparison take turns on the same
points of the map. Counts are of proofs in exact arithmetic: "feasible" at the upper ends of the enclosed rates,
"infeasible" at their lower ends.
"""

import argparse
import math
import resource
import statistics
import sys
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from lmi_peers import Parametrised, rebuilt
from lmi_soundness import soundness

from robust_core.analysis import decide, decide_many, largest_decay, sweep
from robust_core.lmi.margin import MarginSolver
from robust_core.models import PolytopicSystem
from robust_core.plants import chua, chua_formulas, example_2_4_1
from robust_core.theorems import (
    CommonLyapunov,
    ParameterDependent,
    Relaxed,
    Slack,
    TensorCorners,
    TensorProduct,
)
from robust_core.verdict import Verdict
from tracked_report.results import write_metrics

SEED = 2400
TURN = 12  # models that a contender decides before the next one has its turn
BOXES = {"pi40": math.pi / 40.0, "pi2": math.pi / 2.0}
PRINTED = (CommonLyapunov(), ParameterDependent(), Relaxed())
MORE = (Slack(), TensorCorners(), TensorProduct())


def key_of(name: str) -> str:
    """A theorem's name as a metric key."""
    return name.lower().replace(".", "_").replace(" ", "_")


def counts(steps: int, theorems: Sequence[Any], values: dict[str, float], workers: int | None) -> None:
    """Proven verdicts on a steps x steps grid of both boxes."""
    points = example_2_4_1.grid(steps)
    undecided, proven_total, started = 0, 0, time.perf_counter()
    for box, half_width in BOXES.items():
        begun, spent = time.perf_counter(), cpu_of_all()
        found = sweep(theorems, example_2_4_1.Family(half_width), points, workers=workers, progress=_progress)
        values[f"grid{steps}.{box}.wall_s"] = time.perf_counter() - begun
        values[f"grid{steps}.{box}.cpu_s"] = cpu_of_all() - spent
        for row, theorem in enumerate(found.theorems):
            stem = f"grid{steps}.{box}.{key_of(theorem.NAME)}"
            feasible, infeasible = found.count(row, Verdict.PROVEN), found.count(row, Verdict.INFEASIBLE)
            values[f"{stem}.proven"] = feasible
            undecided += len(points) - feasible - infeasible
            proven_total += feasible + infeasible
            margins = np.abs(found.margins[row])
            print(f"  {steps}x{steps} {box:5} {theorem.NAME:6} proven {feasible:6} infeasible {infeasible:6}"
                  f"  least |margin| {np.nanmin(margins):.1e}")  # fmt: skip
    values[f"grid{steps}.undecided"] = undecided
    values[f"grid{steps}.exact_share"] = proven_total / (len(points) * len(theorems) * len(BOXES))
    print(f"  {steps}x{steps} in {time.perf_counter() - started:.1f} s, undecided {undecided}")


def _progress(done: int, total: int) -> None:
    if sys.stderr.isatty():
        print(f"\r{done} of {total}", end="\n" if done == total else "", file=sys.stderr, flush=True)


def cpu_of_all() -> float:
    """CPU time of this process and of its children that have ended (s)."""
    use = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in use)


def timed(work: Callable[[], Any]) -> float:
    """Thread CPU time of a call (ms)."""
    begun = time.thread_time()
    work()
    return 1e3 * (time.thread_time() - begun)


def times(values: dict[str, float], points: int, rebuilds: int) -> None:
    """Theorem 2.3, model to certificate, against cvxpy, on points of the pi/40 map in turn."""
    rng = np.random.default_rng(SEED)
    grid = example_2_4_1.grid(21)
    models = example_2_4_1.Family(BOXES["pi40"])(grid[rng.choice(len(grid), points, replace=False)])
    theorem, solver, special = Relaxed(), MarginSolver(), [Relaxed().specialised(model) for model in models]
    dpp = {z: Parametrised(4, 2, z) for z in {one.z for one in special if one.z is not None}}
    for model, one in zip(models, special, strict=True):
        _warm(theorem, model, solver)
        if one.z is not None:
            dpp[one.z].solve(model.A, model.require_rates("").high)
    taken: dict[str, list[float]] = {"direct": [], "exact": [], "dpp": [], "rebuilt": []}
    for start in range(0, points, TURN):
        turn = list(zip(models[start : start + TURN], special[start : start + TURN], strict=True))
        for name, work in contenders(theorem, solver, dpp).items():
            some = turn[: max(0, rebuilds - start)] if name == "rebuilt" else turn
            taken[name] += [timed(lambda work=work, model=model, one=one: work(model, one)) for model, one in some]
    median = {name: statistics.median(ms) for name, ms in taken.items()}
    decide_many(theorem, models[:2], exact=False)
    batch = timed(lambda: decide_many(theorem, models, exact=False)) / len(models)
    values |= {
        "direct_ms": median["direct"],
        "exact_extra_ms": statistics.median([e - d for e, d in zip(taken["exact"], taken["direct"], strict=True)]),
        "batched_ms": batch,
        "cvxpy_dpp_ms": median["dpp"],
        "cvxpy_rebuilt_ms": median["rebuilt"],
        "ratio_dpp": median["dpp"] / median["direct"],
        "ratio_rebuilt": median["rebuilt"] / median["direct"],
    }
    for n in (3, 4):
        larger = [_larger(rng, n) for _ in range(max(3, points // 10))]
        for name, exact in (("direct", False), ("exact", True)):
            for z in range(4):
                _warm(Relaxed(z=z), larger[0], solver)
            spent = [
                timed(lambda model=model, exact=exact: decide(theorem, model, exact=exact, solver=solver))
                for model in larger
            ]
            values[f"{name}_n{n}_ms"] = statistics.median(spent)


def contenders(
    theorem: Relaxed, solver: MarginSolver, dpp: dict[int, Parametrised]
) -> dict[str, Callable[[PolytopicSystem, Relaxed], Any]]:
    """Ways to decide theorem 2.3 for a model, given the theorem with its z."""
    return {
        "direct": lambda model, _: decide(theorem, model, exact=False, solver=solver),
        "dpp": lambda model, one: dpp[one.z or 0].solve(model.A, model.require_rates("").high),
        "exact": lambda model, _: decide(theorem, model, solver=solver),
        "rebuilt": lambda model, one: rebuilt(model.A, model.require_rates("").high, one.z or 0),
    }


def _warm(theorem: Any, model: PolytopicSystem, solver: MarginSolver) -> None:
    """Let the solver make its template."""
    for _ in range(2):
        decide(theorem, model, solver=solver)


def _larger(rng: np.random.Generator, n: int) -> PolytopicSystem:
    """Four vertices of n states with rates."""
    A = rng.normal(size=(4, n, n))
    A -= (np.linalg.eigvals(A).real.max(axis=1) + 1.0)[:, None, None] * np.eye(n)
    return PolytopicSystem.of(A, rates=rng.uniform(0.0, 0.5, 4))


def map_times(values: dict[str, float], steps: int) -> None:
    """A whole map of theorems 2.1, 2.2, 2.3 in this process: rates enclosed, all points proven."""
    for box, half_width in BOXES.items():
        family, points = example_2_4_1.Family(half_width), example_2_4_1.grid(steps)
        spent = timed(lambda family=family, points=points: sweep(PRINTED, family, points, workers=1))
        values[f"map{steps}.{box}.cpu_s"] = spent / 1e3
        floats = timed(lambda family=family, points=points: sweep(PRINTED, family, points, workers=1, exact=False))
        values[f"map{steps}.{box}.float_cpu_s"] = floats / 1e3


def chua_figures(values: dict[str, float]) -> None:
    """Enclosed rates of Chua's oscillator, and what is certified of the printed gains."""
    rates = chua_formulas.stabilisation().rates(relative=1e-6)
    values["chua.phi4_low"], values["chua.phi4_high"] = float(rates.low[3]), float(rates.high[3])
    for name, model, gains in (
        ("stabilisation", chua.stabilisation(), chua.PRINTED_STABILISATION_GAINS),
        ("synchronisation", chua.synchronisation(), chua.PRINTED_SYNCHRONISATION_GAINS),
    ):
        decay, result = largest_decay(CommonLyapunov(), model.closed_loop(gains), relative=1e-5)
        values[f"chua.{name}_decay"] = decay if result.verdict is Verdict.PROVEN else 0.0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="smaller grids and samples, in seconds")
    parser.add_argument("--systems", type=int, help="random systems of the soundness part")
    parser.add_argument("--workers", type=int, help="processes of the counts (all cores unless given)")
    arguments = parser.parse_args()
    quick = arguments.quick
    values: dict[str, float] = {}
    print("times of theorem 2.3")
    times(values, 24 if quick else 240, 1 if quick else 36)
    if not quick:
        map_times(values, 21)
    chua_figures(values)
    for key, value in values.items():
        print(f"  {key:32} {value:10.4g}")
    print("example 2.4.1")
    counts(11, PRINTED, values, 1)
    if not quick:
        counts(21, (*PRINTED, *MORE), values, arguments.workers)
        counts(101, PRINTED, values, arguments.workers)
    print("soundness")
    systems = arguments.systems or (50 if quick else 10_000)
    values |= {f"soundness.{key}": value for key, value in soundness(SEED, systems).items()}
    for key, value in values.items():
        if key.startswith("soundness"):
            print(f"  {key:40} {value:g}")
    print(write_metrics("lmi", {f"lmi.{key}": value for key, value in values.items()}, seed=SEED))
    return 0


if __name__ == "__main__":
    sys.exit(main())
