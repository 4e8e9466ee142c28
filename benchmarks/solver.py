"""Solvers of both layers against IPOPT, Opti and do-mpc on the same problems, in thread CPU time per call.

The problems of the layers are recorded from the default layers in closed loop on the kinematic plant (obstacle
included), each with the guess that the layer started from, and every solver starts from that guess. The variant with
track-speed and rate limits, and the long horizons, solve problems along a winding path with kicks; there the limits
are narrow enough to bind. Solvers take turns every 25 problems, so that a busy machine meets them all alike. Times
contain the whole call with all copying of arguments and results.
"""

import argparse
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from nmpc_layers.solver import BoxSolver, Motion, Problem, Solution, TrackLimits, TrackSolver
from nmpc_layers.solver.oracle import IpoptOracle
from nmpc_layers.solver.samples import HIGH, LOW, winding_problems
from tracked_description import load_robot
from tracked_lab.closed_loop import ClosedLoop
from tracked_lab.kinematic_ground import Ground
from tracked_lab.kinematic_plant import KinematicPlant
from tracked_lab.ocp_peers import DoMpcPeer, OptiPeer
from tracked_lab.stack import Stack
from tracked_lab.steering import NmpcLayers
from tracked_report.results import write_metrics

Array = NDArray[np.float64]
SEED = 3000  # of the plant; weights were tuned on others
TURN = 25  # problems that a solver solves before the next one has its turn
TIGHT = TrackLimits(half_gauge_m=0.18, track_speed_mps=0.42, acceleration_mps2=0.8, yaw_acceleration_radps2=3.0)
LONG_HORIZONS = (15, 30, 60, 120, 240)
LIFTED = 120


class Contender(Protocol):
    """What solves a problem from a guess."""

    def start_from(self, guess: Array) -> None:
        """Commands (N, 2) to start from."""
        ...

    def solve(self, problem: Problem) -> Any:
        """Solve; the result is looked at outside the timed part."""
        ...


@dataclass(frozen=True, slots=True)
class Task:
    """A problem and the guess to start from."""

    problem: Problem
    guess: Array


class Recorder(BoxSolver):
    """A layer's solver that keeps its problems and the guesses it starts from."""

    def __init__(self, motion: Motion, horizon: int) -> None:
        super().__init__(motion, horizon)
        self.tasks: list[Task] = []

    def solve(self, problem: Problem) -> Solution:
        """Solve as the layer's own solver would."""
        self.tasks.append(Task(problem, self.guess))
        return super().solve(problem)


def recorded(seconds: float) -> tuple[list[Task], list[Task]]:
    """Tasks of the upper and the lower layer from closed-loop runs along an S-curve and a figure eight."""
    robot = load_robot()
    tasks: tuple[list[Task], list[Task]] = ([], [])
    for run, shape in enumerate(("s_curve", "figure_eight")):
        layers = NmpcLayers.from_parameters(robot, {})
        upper, lower = layers.upper, layers.lower
        assert lower is not None
        stack = Stack(robot, {"trajectory_player": {"shape": shape}}, layers)
        loop = ClosedLoop(
            KinematicPlant(robot, SEED + run, Ground.of_seed(SEED + run, obstacle=True, begin_s=2.0)), stack
        )
        upper.solver = upper_recorder = Recorder(Motion.KINEMATIC, upper.settings.horizon)
        lower.solver = lower_recorder = Recorder(Motion.LAG, lower.settings.horizon)
        for _ in range(round(robot.imu.rate_hz * seconds)):
            loop.tick()
        tasks[0].extend(upper_recorder.tasks)
        tasks[1].extend(lower_recorder.tasks)
    return tasks


def timed(contenders: dict[str, Contender], tasks: Sequence[Task], limits: dict[str, int]) -> dict[str, list[Any]]:
    """Times (s) and results of each contender as pairs; ``limits`` caps the problems of the slow ones."""
    outcomes: dict[str, list[Any]] = {name: [] for name in contenders}
    for contender in contenders.values():
        contender.start_from(tasks[0].guess)
        contender.solve(tasks[0].problem)
    for first in range(0, len(tasks), TURN):
        for name, contender in contenders.items():
            for task in tasks[first : min(first + TURN, limits.get(name, len(tasks)))]:
                contender.start_from(task.guess)
                began = time.thread_time()
                result = contender.solve(task.problem)
                outcomes[name].append((time.thread_time() - began, result))
    return outcomes


def milliseconds(outcomes: Sequence[Any]) -> Array:
    """Times of `timed` in ms."""
    return 1e3 * np.array([seconds for seconds, _ in outcomes])


def show(name: str, times: Array, unit_median: float) -> None:
    """One line of the table."""
    median, late = float(np.median(times)), float(np.percentile(times, 99))
    print(f"  {name:<28}{median:>10.4f}{late:>10.4f}{median / unit_median:>12.1f}{len(times):>8}", flush=True)


def cost_gap(own: Sequence[Any], judged: Sequence[Any]) -> float:
    """Largest cost above the judge's, relative to the cost or to 1 where it is less; infinite if one failed."""
    gaps = []
    for (_, solution), (_, truth) in zip(own, judged, strict=False):
        if not solution.converged or not truth.converged:
            return float("inf")
        gaps.append((solution.cost - truth.cost) / max(1.0, truth.cost))
    return max(gaps)


def layer_figures(layer: str, motion: Motion, horizon: int, tasks: list[Task], quick: bool) -> dict[str, float]:
    """Own solver against all peers on the problems of one layer."""
    contenders: dict[str, Contender] = {
        "own": BoxSolver(motion, horizon),
        "ipopt": IpoptOracle(motion, horizon, tolerance=1e-8),
        "ipopt_1e-10": IpoptOracle(motion, horizon),
    }
    limits = {"ipopt": 50, "ipopt_1e-10": 50} if quick else {"opti": 150, "dompc": 100}
    if not quick:
        contenders["opti"] = OptiPeer(motion, horizon)
        contenders["dompc"] = DoMpcPeer(motion, horizon, tasks[0].problem)
    print(f"{layer} layer, N={horizon}")
    outcomes = timed(contenders, tasks, limits)
    own = milliseconds(outcomes["own"])
    for name in contenders:
        show(name, milliseconds(outcomes[name]), float(np.median(own)))
    values = {
        f"solver.{layer}_median_ms": float(np.median(own)),
        f"solver.{layer}_p99_ms": float(np.percentile(own, 99)),
        f"solver.{layer}_cost_gap": cost_gap(outcomes["own"], outcomes["ipopt_1e-10"]),
        f"solver.{layer}_iterations_mean": float(np.mean([result.iterations for _, result in outcomes["own"]])),
    }
    for peer in ("ipopt", "opti", "dompc"):
        if peer in outcomes:
            # The same problems for both sides of the ratio, where a slow peer solved fewer.
            shared = own[: len(outcomes[peer])]
            values[f"solver.ratio_{peer}_{layer}"] = float(np.median(milliseconds(outcomes[peer])) / np.median(shared))
    return values


class Constrained:
    """A solver of the constrained variant that feeds its first command back as the one in force."""

    def __init__(self, solver: TrackSolver | IpoptOracle, commands: Sequence[Array]) -> None:
        self._solver, self._in_force = solver, iter(commands)

    def start_from(self, guess: Array) -> None:
        """Commands (N, 2) to start from."""
        self._solver.start_from(guess)

    def solve(self, problem: Problem) -> Solution:
        """Solve after the next command in force."""
        return self._solver.solve(problem, next(self._in_force))


def violation(commands: Array, previous: Array, period_s: float) -> float:
    """By how much commands (N, 2) exceed box, track-speed or rate limits; negative within them."""
    tracks = np.abs(commands @ np.array([[1.0, 1.0], [TIGHT.half_gauge_m, -TIGHT.half_gauge_m]]))
    changes = np.abs(np.diff(np.vstack([previous, commands]), axis=0)) - TIGHT.steps(period_s)
    box = np.maximum(LOW - commands, commands - HIGH)
    return float(max(tracks.max() - TIGHT.track_speed_mps, changes.max(), box.max()))


def constrained_figures(quick: bool) -> dict[str, float]:
    """The condensed solver with binding track-speed and rate limits against IPOPT, N=15."""
    horizon, period_s, count = 15, 1.0 / 30.0, 75 if quick else 300
    problems = winding_problems(Motion.LAG, horizon, period_s, count, SEED)
    pilot, in_force, tasks = TrackSolver(Motion.LAG, horizon, TIGHT), [np.zeros(2)], []
    for problem in problems:
        tasks.append(Task(problem, pilot.guess))
        in_force.append(pilot.solve(problem, in_force[-1]).commands[0])
        pilot.shift(1)
    # `timed` solves the first problem once more, to warm up.
    order = [in_force[0], *in_force]
    contenders: dict[str, Contender] = {
        "own": Constrained(TrackSolver(Motion.LAG, horizon, TIGHT), order),
        "ipopt": Constrained(IpoptOracle(Motion.LAG, horizon, TIGHT, tolerance=1e-8), order),
        "ipopt_1e-10": Constrained(IpoptOracle(Motion.LAG, horizon, TIGHT), order),
    }
    print(f"track-speed and rate limits, N={horizon}")
    outcomes = timed(contenders, tasks, {"ipopt": 50, "ipopt_1e-10": 50} if quick else {})
    own = milliseconds(outcomes["own"])
    for name in contenders:
        show(name, milliseconds(outcomes[name]), float(np.median(own)))
    excess = [
        violation(solution.commands, before, period_s)
        for (_, solution), before in zip(outcomes["own"], in_force, strict=False)
    ]
    ipopt = milliseconds(outcomes["ipopt"])
    return {
        "constrained.median_ms": float(np.median(own)),
        "constrained.p99_ms": float(np.percentile(own, 99)),
        "constrained.ratio_ipopt": float(np.median(ipopt) / np.median(own[: len(ipopt)])),
        "constrained.limit_excess_max": max(*excess, 0.0),
        "constrained.binding_share": float(np.mean([value > -1e-6 for value in excess])),
        "constrained.cost_gap_max": cost_gap(outcomes["own"], outcomes["ipopt_1e-10"]),
    }


def growth_figures(quick: bool) -> dict[str, float]:
    """Times over the horizon: the lifted single layer, N=120, and how they grow."""
    horizons = (30, 60, LIFTED) if quick else LONG_HORIZONS
    period_s, count = 1.0 / 30.0, 75 if quick else 200
    print("box limits over the horizon")
    solvers = {horizon: BoxSolver(Motion.KINEMATIC, horizon) for horizon in horizons}
    problems = {horizon: winding_problems(Motion.KINEMATIC, horizon, period_s, count, SEED) for horizon in horizons}
    times: dict[int, list[float]] = {horizon: [] for horizon in horizons}
    for horizon in horizons:
        solvers[horizon].solve(problems[horizon][0])
    for first in range(0, count, TURN):
        for horizon in horizons:
            for problem in problems[horizon][first : first + TURN]:
                began = time.thread_time()
                solvers[horizon].solve(problem)
                times[horizon].append(time.thread_time() - began)
                solvers[horizon].shift(1)
    taken = {horizon: 1e3 * np.array(seconds) for horizon, seconds in times.items()}
    for horizon in horizons:
        show(f"N={horizon}", taken[horizon], float(np.median(taken[horizons[0]])))
    medians = [float(np.median(taken[horizon])) for horizon in horizons]
    slope = np.polyfit(np.log(horizons[-3:]), np.log(medians[-3:]), 1)[0]
    return {
        "lifted.median_ms": float(np.median(taken[LIFTED])),
        "lifted.p99_ms": float(np.percentile(taken[LIFTED], 99)),
        "growth.slope": float(slope),
    }


def main() -> None:
    """Measure, print a table and write the metrics."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer problems, and neither Opti nor do-mpc")
    quick = parser.parse_args().quick
    upper, lower = recorded(4.0 if quick else 16.0)
    print(f"  {'ms of thread CPU time':<28}{'median':>10}{'p99':>10}{'x first':>12}{'calls':>8}")
    values: dict[str, float] = {}
    parts: list[Callable[[], dict[str, float]]] = [
        lambda: layer_figures("upper", Motion.KINEMATIC, 10, upper, quick),
        lambda: layer_figures("lower", Motion.LAG, 15, lower, quick),
        lambda: constrained_figures(quick),
        lambda: growth_figures(quick),
    ]
    for part in parts:
        values |= part()
    values["solver.cost_gap_max"] = max(values["solver.upper_cost_gap"], values["solver.lower_cost_gap"])
    print(write_metrics("solver", values, seed=SEED))


if __name__ == "__main__":
    main()
