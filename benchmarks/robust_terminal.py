"""The proven terminal weight of the upper layer against the scaled one, in the lab on both plants.

The same runs twice: the demo's S-curve over the step and named shapes on even ground that the seed draws, on belts; and
shapes on the kinematic plant, where the robot is turned by force once. Figures are means over the runs of a plant:
RMS of distance and heading error in the frame of the estimate and of the truth, and command effort, the RMS
acceleration of speed and yaw rate. What is claimed is the largest of their relative changes for the worse; peak-to-peak
errors and jerk stand beside them. Also: in how many plans the weight was used, and how many of these end in its set.
"""

import argparse
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nmpc_layers.solver import BoxSolver, Motion, Problem, Solution
from tracked_bringup.node_table import load_node_table
from tracked_bringup.scenarios import load_scenario
from tracked_description import load_robot
from tracked_lab import drive
from tracked_lab.closed_loop import ClosedLoop
from tracked_lab.conditions import Conditions
from tracked_lab.kinematic_ground import Ground
from tracked_lab.kinematic_plant import KinematicPlant
from tracked_lab.stack import Stack
from tracked_lab.steering import NmpcLayers
from tracked_report.metrics import run_metrics
from tracked_report.results import write_metrics
from tracked_report.scenario import Reference, Scenario

Array = NDArray[np.float64]
SEED = 6000  # nothing was tuned or decided on this and the following ones
SHAPES = ("s_curve", "figure_eight", "circle")
CLAIMED = (
    *(f"{frame}.rms_{what}" for frame in ("estimated", "true") for what in ("distance_m", "theta_rad")),
    *(f"command.rms_{what}" for what in ("acceleration_mps2", "yaw_acceleration_radps2")),
)
BESIDE = (
    *(f"{frame}.ptop_{what}" for frame in ("estimated", "true") for what in ("x_m", "y_m", "theta_rad")),
    *(f"command.rms_{what}" for what in ("jerk_mps3", "yaw_jerk_radps3")),
)


@dataclass(frozen=True, slots=True)
class Run:
    """One scenario under its conditions."""

    scenario: Scenario
    conditions: Conditions


def runs(count: int) -> dict[str, list[Run]]:
    """``count`` runs on each plant, every one with a seed of its own."""
    table = load_node_table()
    demo, track = (load_scenario(name, [], table) for name in ("compare", "track"))
    found: dict[str, list[Run]] = {"belts": [], "kinematic": []}
    for number in range(count):
        shape = Reference(shape=SHAPES[number % len(SHAPES)])
        shaped = track.model_copy(update={"reference": shape, "duration_s": 25.0})
        on_belts = demo if number % 2 == 0 else shaped
        found["belts"].append(Run(_seeded(on_belts, SEED + number), Conditions(varied_ground=True)))
        turned = Conditions(plant="kinematic", obstacle=True)
        found["kinematic"].append(Run(_seeded(shaped, SEED + count + number), turned))
    return found


def _seeded(scenario: Scenario, seed: int) -> Scenario:
    return scenario.model_copy(update={"seed": seed, "time": "lock_step"})


def means(cases: Sequence[Run], terminal: str) -> dict[str, float]:
    """Mean figures of the runs with one kind of terminal weight."""
    sheets = []
    for case in cases:
        scenario = case.scenario.model_copy(update={"parameters": {"upper_nmpc": {"terminal": terminal}}})
        sheets.append(run_metrics(drive(scenario, "double", conditions=case.conditions)).values)
    return {key: float(np.mean([sheet[key] for sheet in sheets])) for key in (*CLAIMED, *BESIDE)}


class Recorder(BoxSolver):
    """The upper layer's solver, with what it solved."""

    def __init__(self, horizon: int) -> None:
        super().__init__(Motion.KINEMATIC, horizon)
        self.solved: list[tuple[Problem, Solution]] = []

    def solve(self, problem: Problem) -> Solution:
        """Solve as the layer's own solver would."""
        solution = super().solve(problem)
        self.solved.append((problem, solution))
        return solution


def plan_figures(shapes: Sequence[str], seconds: float) -> dict[str, float]:
    """Share of plans that the proof is about, and share of these whose last pose is in the invariant set."""
    robot, covered, inside, plans = load_robot(), 0, 0, 0
    for number, shape in enumerate(shapes):
        layers = NmpcLayers.from_parameters(robot, {})
        layers.upper.solver = recorder = Recorder(layers.upper.settings.horizon)
        ground = Ground.of_seed(SEED + number, obstacle=True, begin_s=2.0)
        stack = Stack(robot, {"trajectory_player": {"shape": shape}}, layers)
        loop = ClosedLoop(KinematicPlant(robot, SEED + number, ground), stack)
        for _ in range(round(robot.imu.rate_hz * seconds)):
            loop.tick()
        certified = layers.upper.settings.certified
        assert certified is not None
        used = [(p, s) for p, s in recorder.solved if p.terminal is not None and s.converged]
        values = [_value(problem, solution) for problem, solution in used]
        covered, plans = covered + len(used), plans + len(recorder.solved)
        inside += sum(value <= certified.level for value in values)
    return {"plans.covered_share": covered / plans, "plans.end_in_set_share": inside / max(covered, 1)}


def _value(problem: Problem, solution: Solution) -> float:
    """e'P e of the last pose of a plan."""
    assert problem.terminal is not None
    x, y, turn = (solution.states[-1, :3] - problem.state_reference[-1]).tolist()
    c, s = math.cos(problem.state_reference[-1, 2]), math.sin(problem.state_reference[-1, 2])
    error = np.array([c * x + s * y, c * y - s * x, turn])
    return float(error @ problem.terminal.matrix @ error)


def main() -> int:
    """Measure, print and write the metrics."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=24, help="on each plant, with each weight (default: %(default)s)")
    count: int = parser.parse_args().runs
    values: dict[str, float] = {"runs_per_plant": float(count)}
    worst = {"claimed": -np.inf, "beside": -np.inf}
    for plant, cases in runs(count).items():
        scaled, certified = means(cases, "scaled"), means(cases, "certified")
        print(f"{plant:44}{'scaled':>10}{'certified':>11}{'change':>9}")
        for key in (*CLAIMED, *BESIDE):
            change = certified[key] / scaled[key] - 1.0
            print(f"  {key:42}{scaled[key]:10.4g}{certified[key]:11.4g}{100.0 * change:+8.2f} %", flush=True)
            kind = "claimed" if key in CLAIMED else "beside"
            worst[kind] = max(worst[kind], change)
            values |= {f"{plant}.{key}.scaled": scaled[key], f"{plant}.{key}.certified": certified[key]}
            values[f"{plant}.{key}.worsening_percent"] = 100.0 * change
    values |= {f"worsening_{kind}_percent": 100.0 * share for kind, share in worst.items()}
    values |= plan_figures(SHAPES, 12.0)
    for key in (
        "worsening_claimed_percent",
        "worsening_beside_percent",
        "plans.covered_share",
        "plans.end_in_set_share",
    ):
        print(f"{key:44}{values[key]:10.4g}")
    print(write_metrics("robust_terminal", values, seed=SEED))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
