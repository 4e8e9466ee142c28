"""Does a polytopic model say the same as the system it stands for?"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.errors import ModelMismatchError
from robust_core.rational import Floats, to_float
from robust_core.symbolic.packages import casadi_module
from robust_core.symbolic.system import StateDependentModel


@dataclass(frozen=True, slots=True)
class Agreement:
    """Largest difference of matrices found, largest weight below 0, and largest error of a group's sum."""

    matrices: float
    negative_weight: float
    group_sum: float
    points: int


def check_agreement(
    model: StateDependentModel, parameters: Any = (), *, seed: int = 0, points: int = 2000, relative: float = 1e-9
) -> Agreement:
    """Compare at random points of the box, at its corners and centre, and where a search finds the largest difference.

    Raises
    ------
    ModelMismatchError: naming the matrix entry, the weight or the group that disagrees, and where.
    """
    casadi = casadi_module()
    rng = np.random.default_rng(seed)
    mixed = sum(model.weights[r] * model.vertices[r] for r in range(model.simplices.count))
    gaps = [casadi.vec(mixed - model.matrix)]
    names = [f"A[{i}, {j}]" for j in range(mixed.shape[1]) for i in range(mixed.shape[0])]
    if model.inputs is not None:
        pushed = sum(model.weights[r] * model.inputs[r] for r in range(model.simplices.count))
        gaps.append(casadi.vec(pushed - model.input_matrix))
        names += [f"B[{i}, {j}]" for j in range(pushed.shape[1]) for i in range(pushed.shape[0])]
    function = casadi.Function("gap", [model.variables, model.parameters], [casadi.vertcat(*gaps), model.weights])
    values = np.ravel(np.asarray(parameters, dtype=np.float64))
    scale = max(1.0, float(np.abs(model.system(values).A).max()))

    def evaluate(where: Floats) -> tuple[Floats, Floats]:
        batch = function.map(where.shape[1])(where, np.repeat(values[:, None], where.shape[1], axis=1))
        return np.array(batch[0]), np.array(batch[1])

    where = _points(model, rng, points)
    gap, weights = evaluate(where)
    # Adversarial: shrink a cloud around the worst point seen.
    reach = 0.5 * (model.high - model.low)
    for _ in range(12):
        centre = where[:, [int(np.abs(gap).max(axis=0).argmax())]]
        reach = 0.5 * reach
        cloud = centre + reach[:, None] * rng.uniform(-1.0, 1.0, (len(reach), 50))
        cloud = np.clip(cloud, model.low[:, None], model.high[:, None])
        more, more_weights = evaluate(cloud)
        where, gap = np.hstack([where, cloud]), np.hstack([gap, more])
        weights = np.hstack([weights, more_weights])
    return _judge(model, names, where, gap, weights, relative * scale)


def _points(model: StateDependentModel, rng: np.random.Generator, count: int) -> Floats:
    d = len(model.low)
    random = rng.uniform(model.low, model.high, (count, d))
    signs = np.array(np.meshgrid(*[[0.0, 1.0]] * min(d, 8))).reshape(min(d, 8), -1).T
    corners = np.zeros((len(signs), d))
    corners[:, : signs.shape[1]] = signs
    return np.vstack([random, model.low + corners * (model.high - model.low), np.zeros((1, d))]).T


def _judge(
    model: StateDependentModel, names: list[str], where: Floats, gap: Floats, weights: Floats, allowed: float
) -> Agreement:
    worst, place = np.unravel_index(np.abs(gap).argmax(), gap.shape)
    error = float(np.abs(gap).max())
    if not error <= allowed:
        raise ModelMismatchError(
            f"the vertices do not mix to the system: {names[int(worst)]} is off by {gap[worst, place]:.6g} at "
            f"{where[:, place].tolist()}"
        )
    lowest = float(weights.min())
    if not lowest >= -1e-9:
        r, place = np.unravel_index(weights.argmin(), weights.shape)
        raise ModelMismatchError(f"weight {int(r)} is {lowest:.6g}, below 0, at {where[:, place].tolist()}")
    sums = 0.0
    for group, total in zip(model.simplices.groups, to_float(np.array(model.simplices.totals)), strict=True):
        off = float(np.abs(weights[list(group)].sum(axis=0) - total).max())
        if not off <= 1e-9:
            raise ModelMismatchError(f"the weights {group} sum to {total:g} only within {off:.6g}")
        sums = max(sums, off)
    return Agreement(error, max(0.0, -lowest), sums, where.shape[1])
