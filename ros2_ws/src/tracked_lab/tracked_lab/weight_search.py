"""How well a way to drive does on the tuning seeds, and the weights files that are tried.

The score is the mean over the seeds of RMS and peak-to-peak errors in the true frame, each over a typical value, of the
time to recover from a sudden change of pose, and a little of how much the commands change.
"""

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path

import yaml

from nmpc_layers import load_weights
from nmpc_layers.solver import Weights
from tracked_lab.conditions import Conditions
from tracked_lab.lock_step import drive
from tracked_lab.parameter_search import Point, Ranges
from tracked_lab.table_variants import TableVariant
from tracked_report.metrics import run_metrics
from tracked_report.scenario import Reference, Scenario, Variant

SEEDS = tuple(range(1000, 1008))
"""For tuning only: no figure is reported on seeds from 1000 on."""
LATENCY_S, DURATION_S = 0.1, 10.0
LONGEST_RECOVERY_S = 3.0
_TYPICAL = {"x_m": 0.02, "y_m": 0.02, "theta_rad": 0.06}
_RANGES = {"heading": (0.3, 30.0), "speed": (0.05, 20.0), "yaw_rate": (0.01, 5.0), "terminal": (1.0, 30.0)}
_POSITION = 20.0  # only ratios of weights matter


def weight_ranges(way: TableVariant) -> Ranges:
    """What is searched for one way to drive: ``role.weight``."""
    return {f"{role}.{name}": ends for role in way.roles for name, ends in _RANGES.items()}


def packaged_point(way: TableVariant) -> Point:
    """The packaged weights, where the search starts."""
    packaged = load_weights().of(way.method)
    return {f"{role}.{name}": getattr(getattr(packaged, role), name) for role in way.roles for name in _RANGES}


def roles_of(point: Point) -> dict[str, Weights]:
    """Weights by role."""
    found = {}
    for role in sorted({name.partition(".")[0] for name in point}):
        found[role] = Weights(position=_POSITION, **{name: point[f"{role}.{name}"] for name in _RANGES})
    return found


def write_weights(roles: Mapping[str, Weights], path: Path, comment: str = "") -> None:
    """A weights file in which both methods have these weights; roles that are not named keep the packaged ones."""
    packaged = load_weights().improved
    every = {"single": packaged.single, "upper": packaged.upper, "lower": packaged.lower} | dict(roles)
    entry = {role: asdict(weights) for role, weights in every.items()}
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(comment + yaml.safe_dump({"improved": entry, "thesis": entry}, sort_keys=False))


def tuning_conditions(seed: int) -> Conditions:
    """Kinematic plant and lidar pose; every other seed has the sudden change of pose."""
    return Conditions(plant="kinematic", pose="lidar", obstacle=seed % 2 == 0)


def score(variant: Variant, conditions: Conditions, seed: int) -> float:
    """How badly one run goes."""
    scenario = Scenario(
        name="tuning",
        world="flat",
        seed=seed,
        duration_s=DURATION_S,
        reference=Reference(shape="s_curve"),
        pipeline_latency_s=LATENCY_S,
        variants={"tuned": variant},
    )
    values = run_metrics(drive(scenario, "tuned", conditions=conditions)).values
    total = 0.0
    for axis, typical in _TYPICAL.items():
        total += values[f"true.rms_{axis}"] / typical + 0.25 * values[f"true.ptop_{axis}"] / (4.0 * typical)
    if conditions.obstacle:
        total += 0.5 * min(values.get("true.recovery_s", LONGEST_RECOVERY_S), LONGEST_RECOVERY_S)
    total += 0.1 * values["command.rms_acceleration_mps2"] / 0.5
    return total + 0.1 * values["command.rms_yaw_acceleration_radps2"] / 2.0
