"""Fig 5.13: one lifted layer (N = 120 at 30 Hz) against two (N = 20 at 5 Hz, N = 20 at 30 Hz), by several solvers.

A dense Gauss-Newton solver stands for the thesis's setting (78.29 ms against 6.20 ms, 12.6 times). Shown are the ratio
per cycle, the worst 30 Hz step, processor seconds per second of driving, and the growth with the horizon. Times are of
this thread; solvers take turns, so that ratios hold on a busy machine.
"""

import argparse
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from nmpc_layers.solver import BoxSolver, Motion, Problem
from nmpc_layers.solver.oracle import IpoptOracle
from nmpc_layers.solver.samples import winding_problems
from tracked_lab.dense_gauss_newton import DenseGaussNewton
from tracked_lab.shooting_solver import ShootingSolver
from tracked_report.results import write_metrics

LIFTED, UPPER, LOWER = (120, 1 / 30), (20, 0.2), (20, 1 / 30)
HORIZONS = (10, 20, 40, 80, 120, 240)
TURN = 25
SOLVERS: dict[str, Callable[[int], Any]] = {
    "dense": DenseGaussNewton,
    "ipopt": lambda horizon: IpoptOracle(Motion.KINEMATIC, horizon, tolerance=1e-6),
    "fatrop": lambda horizon: ShootingSolver("fatrop", horizon),
    "sqpmethod": lambda horizon: ShootingSolver("sqpmethod", horizon),
    "own": lambda horizon: BoxSolver(Motion.KINEMATIC, horizon),
}
TITLES = {
    "dense": "dense Gauss-Newton",
    "ipopt": "IPOPT",
    "fatrop": "fatrop",
    "sqpmethod": "sqpmethod (qrqp)",
    "own": "own (Riccati)",
}


Times = dict[tuple[str, int, float], np.ndarray]


def measured(settings: list[tuple[int, float]], count: int) -> Times:
    """Times (ms) by solver, horizon and period; every solver starts from the reference's inputs."""
    problems = {each: winding_problems(Motion.KINEMATIC, *each, count, seed=5000) for each in settings}
    solvers = {(name, *each): SOLVERS[name](each[0]) for name in SOLVERS for each in settings}
    times: dict[tuple[str, int, float], list[float]] = {key: [] for key in solvers}
    for key, solver in solvers.items():  # the first solve is always slow
        timed(solver, problems[key[1:]][0])
    for first in range(0, count, TURN):
        for key, solver in solvers.items():
            for problem in problems[key[1:]][first : first + TURN]:
                times[key].append(1e3 * timed(solver, problem))
        print(f"  {min(first + TURN, count)} of {count} problems", flush=True)
    return {key: np.array(values) for key, values in times.items()}


def timed(solver: Any, problem: Problem) -> float:
    """Seconds of one solve."""
    solver.start_from(problem.input_reference)
    began = time.thread_time()
    solver.solve(problem)
    return time.thread_time() - began


def compared(times: Times) -> dict[str, float]:
    """The figure's numbers, and its table on the terminal."""
    values: dict[str, float] = {}
    head = ("lifted", "upper", "lower", "per cycle", "worst step", "CPU lifted", "double")
    print("\n" + " " * 20 + "".join(f"{word:>12}" for word in head))
    for name, title in TITLES.items():
        lifted, upper, lower = (float(np.median(times[(name, *each)])) for each in (LIFTED, UPPER, LOWER))
        values[f"{name}.lifted_ms"], values[f"{name}.double_ms"] = lifted, upper + lower
        values[f"{name}.lifted_p99_ms"] = float(np.percentile(times[(name, *LIFTED)], 99))
        values[f"{name}.ratio"] = lifted / (upper + lower)
        values[f"{name}.worst_step_ratio"] = lifted / lower
        values[f"{name}.lifted_cpu_share"] = 30e-3 * lifted
        values[f"{name}.double_cpu_share"] = 1e-3 * (5 * upper + 30 * lower)
        row = [lifted, upper, lower, values[f"{name}.ratio"], values[f"{name}.worst_step_ratio"]]
        shares = [values[f"{name}.lifted_cpu_share"], values[f"{name}.double_cpu_share"]]
        print(f"{title:<20}" + "".join(f"{value:>12.3f}" for value in row) + "".join(f"{x:>12.4f}" for x in shares))
    values["double_gain"] = values["dense.double_ms"] / values["own.double_ms"]
    values["lifted_gain"] = values["dense.lifted_ms"] / values["own.lifted_ms"]
    return values


def grown(times: Times, horizons: list[int]) -> dict[str, float]:
    """Slope of the time over the horizon, both in logarithms, over the last three horizons."""
    values = {}
    print(f"\n{'growth (ms at N)':<20}" + "".join(f"{horizon:>9}" for horizon in horizons) + f"{'slope':>9}")
    for name, title in TITLES.items():
        medians = [float(np.median(times[(name, horizon, 1 / 30)])) for horizon in horizons]
        slope = float(np.polyfit(np.log(horizons[-3:]), np.log(medians[-3:]), 1)[0])
        values[f"{name}.slope"] = slope
        print(f"{title:<20}" + "".join(f"{median:>9.3f}" for median in medians) + f"{slope:>9.2f}")
        if name == "own":
            values |= explained(horizons, medians)
    return values


def explained(horizons: list[int], medians: list[float]) -> dict[str, float]:
    """Our time as a part of every call and a part of every stage: why 120 stages cost less than three times 40."""
    stage_ms, call_ms = np.polyfit(horizons, medians, 1, w=1.0 / np.array(medians)).tolist()
    lifted, both = call_ms + LIFTED[0] * stage_ms, 2.0 * call_ms + (UPPER[0] + LOWER[0]) * stage_ms
    print(f"  own: {1e3 * call_ms:.1f} us a call, {1e3 * stage_ms:.2f} us a stage: {lifted / both:.1f} times, not 3")
    return {"own.call_ms": call_ms, "own.stage_ms": stage_ms}


def plot(values: dict[str, float], growth: Times, horizons: list[int], file: Path) -> None:
    """Left as in the thesis, right the growth that explains it."""
    figure, (bars, lines) = plt.subplots(1, 2, figsize=(11, 4.2), layout="constrained")
    places = np.arange(len(TITLES))
    bars.bar(places - 0.2, [values[f"{name}.lifted_ms"] for name in TITLES], 0.4, label="one lifted layer, N = 120")
    bars.bar(places + 0.2, [values[f"{name}.double_ms"] for name in TITLES], 0.4, label="two layers, N = 20 + 20")
    for place, name in zip(places, TITLES, strict=True):
        ratio = values[f"{name}.ratio"]
        bars.annotate(f"{ratio:.1f}x", (place, 1.15 * values[f"{name}.lifted_ms"]), ha="center")
    bars.set(yscale="log", ylabel="processor time per cycle (ms)", title="Fig 5.13 by five solvers")
    bars.set_ylim(top=3.0 * max(values[f"{name}.lifted_ms"] for name in TITLES))
    bars.set_xticks(places, TITLES.values(), rotation=15)
    bars.legend()
    for name, title in TITLES.items():
        medians = [np.median(growth[(name, horizon, 1 / 30)]) for horizon in horizons]
        lines.plot(horizons, medians, "o-", label=f"{title}, N^{values[f'{name}.slope']:.1f}")
    lines.set(xscale="log", yscale="log", xlabel="horizon N", ylabel="ms", title="growth with the horizon")
    lines.grid(which="both", alpha=0.3)
    lines.legend()
    figure.savefig(file)
    plt.close(figure)


def main() -> None:
    """Measure, print, plot and write metrics."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer problems; no horizon beyond 120")
    quick = parser.parse_args().quick
    horizons = list(HORIZONS[:-1] if quick else HORIZONS)
    times = measured([LIFTED, UPPER, LOWER], 25 if quick else 50)
    values = compared(times)
    growth = measured([(horizon, 1 / 30) for horizon in horizons], 10 if quick else 25)
    values |= grown(growth, horizons)
    name = "figure_5_13_quick" if quick else "figure_5_13"
    file = write_metrics(name, values, seed=5000)
    plot(values, growth, horizons, file.parent / "figure_5_13.svg")
    print("\nthe thesis: 78.29 ms against 6.20 ms, 12.6 times, by a dense solver")
    print(file, file.parent / "figure_5_13.svg", sep="\n")
    if quick:
        print("left out: half of the problems, N = 240")


if __name__ == "__main__":
    main()
