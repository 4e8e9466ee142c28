"""Search for the weights of one way to drive: random first, then around the best, with the same budget for everybody.

The score of a set of weights is the mean over the tuning seeds of RMS and peak-to-peak errors in the true frame, each
over a typical value, and a little of how much the commands change.
"""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import yaml
from numpy.random import Generator

from nmpc_layers import load_weights
from nmpc_layers.solver import Weights
from tracked_lab.conditions import Conditions
from tracked_lab.lock_step import drive
from tracked_lab.table_variants import TableVariant
from tracked_report.metrics import run_metrics
from tracked_report.scenario import Scenario

SEEDS = tuple(range(1000, 1008))
"""For tuning only: no figure is reported on seeds from 1000 on."""
LATENCY_S, DURATION_S = 0.1, 10.0
_TYPICAL = {"x_m": 0.02, "y_m": 0.02, "theta_rad": 0.06}
_RANGES = {"heading": (0.3, 30.0), "speed": (0.05, 20.0), "yaw_rate": (0.01, 5.0), "terminal": (1.0, 30.0)}
_POSITION = 20.0  # only ratios of weights matter

Roles = Mapping[str, Weights]


@dataclass(frozen=True, slots=True)
class Trial:
    """One set of weights and its score; the lower the better."""

    number: int
    roles: Roles
    score: float


def write_weights(roles: Roles, path: Path, comment: str = "") -> None:
    """A weights file in which both methods have these weights; roles that are not named keep the packaged ones."""
    packaged = load_weights().improved
    every = {"single": packaged.single, "upper": packaged.upper, "lower": packaged.lower} | dict(roles)
    entry = {role: asdict(weights) for role, weights in every.items()}
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(comment + yaml.safe_dump({"improved": entry, "thesis": entry}, sort_keys=False))


def score(way: TableVariant, weights_file: Path, seed: int) -> float:
    """How badly one run goes; every other seed has the sudden change of pose."""
    scenario = Scenario(
        name="tuning",
        world="flat",
        seed=seed,
        duration_s=DURATION_S,
        reference={"shape": "s_curve"},  # type: ignore[arg-type]
        pipeline_latency_s=LATENCY_S,
        variants={"tuned": way.with_weights(weights_file)},
    )
    conditions = Conditions(plant="kinematic", pose="lidar", obstacle=seed % 2 == 0)
    record = drive(scenario, "tuned", conditions=way.with_weights_in(conditions, weights_file))
    values = run_metrics(record).values
    total = 0.0
    for axis, typical in _TYPICAL.items():
        total += values[f"true.rms_{axis}"] / typical + 0.25 * values[f"true.ptop_{axis}"] / (4.0 * typical)
    total += 0.1 * values["command.rms_acceleration_mps2"] / 0.5
    return total + 0.1 * values["command.rms_yaw_acceleration_radps2"] / 2.0


def proposals(way: TableVariant, budget: int, generator: Generator) -> Iterator["Proposal"]:
    """As many sets of weights as the budget; tell each its score before asking for the next.

    The first is the packaged one, a third is drawn anywhere, the rest around the best so far.
    """
    packaged = load_weights().of(way.method)
    best = Proposal({role: getattr(packaged, role) for role in way.roles})
    yield best
    for number in range(1, budget):
        if number <= budget // 3:
            proposal = Proposal({role: _anywhere(generator) for role in way.roles})
        else:
            reach = 0.7 * (1.0 - 0.7 * number / budget)
            proposal = Proposal({role: _near(weights, reach, generator) for role, weights in best.roles.items()})
        yield proposal
        if proposal.score < best.score:
            best = proposal


@dataclass(slots=True)
class Proposal:
    """Weights to try; whoever tries them enters the score."""

    roles: Roles
    score: float = float("inf")


def _anywhere(generator: Generator) -> Weights:
    drawn = {name: float(np.exp(generator.uniform(*np.log(ends)))) for name, ends in _RANGES.items()}
    return _rounded(drawn)


def _near(weights: Weights, reach: float, generator: Generator) -> Weights:
    moved = {}
    for name, (low, high) in _RANGES.items():
        factor = float(np.exp(reach * generator.standard_normal())) if generator.random() < 0.7 else 1.0
        moved[name] = min(max(getattr(weights, name) * factor, low), high)
    return _rounded(moved)


def _rounded(values: Mapping[str, float]) -> Weights:
    return Weights(position=_POSITION, **{name: float(f"{value:.3g}") for name, value in values.items()})
