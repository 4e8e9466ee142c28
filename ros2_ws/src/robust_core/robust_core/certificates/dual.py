"""Farkas certificates: multipliers that show that a theorem's inequalities have no solution.

For F_k(y) = F_k0 + sum_i y_i F_ki, positive definite (strict) or semidefinite: multipliers Z_k >= 0 with
sum_k <Z_k, F_ki> = 0 for every i, and sum_k <Z_k, F_k0> negative, or zero with the Z of some strict constraint not
zero, rule out every y.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from robust_core.errors import ArgumentError, ProofFailedError
from robust_core.lmi.constraint import Constraint
from robust_core.rational import Exact, Floats, all_zero, definite, exact_array, rational, solve_exact
from robust_core.theorems.base import Model, Theorem

_PUSH = 1e-9
_WHOLE = 2.0**44


def check_dual(theorem: Theorem, model: Model, multipliers: Mapping[str, Exact]) -> None:
    """The multipliers prove infeasibility at the lower bounds of the rates, hence at the true ones.

    Raises
    ------
    ProofFailedError: if they do not; the text says what fails.
    """
    _check(_exact_constraints(theorem, model), multipliers)


def _check(constraints: Sequence[Constraint], multipliers: Mapping[str, Exact]) -> None:
    if set(multipliers) != {constraint.name for constraint in constraints}:
        raise ProofFailedError("the multipliers are not those of this theorem's inequalities")
    for constraint in constraints:
        Z = multipliers[constraint.name]
        if Z.shape != constraint.matrices.shape[1:] or not (np.swapaxes(Z, -1, -2) == Z).all():
            raise ProofFailedError(f"the multipliers of {constraint.name} have the wrong shape or are not symmetric")
        if not definite(Z, strict=False).all():
            raise ProofFailedError(f"a multiplier of {constraint.name} is not positive semidefinite")
    constant, linear = _pairing(constraints, [multipliers[c.name] for c in constraints])
    if not all_zero(linear):
        raise ProofFailedError("the multipliers do not annihilate the unknowns")
    some = any(not all_zero(multipliers[c.name].ravel()) for c in constraints if c.strict)
    if not (constant < 0 or (constant == 0 and some)):
        raise ProofFailedError("the multipliers contradict nothing")


def prove_infeasible(theorem: Theorem, model: Model, found: Sequence[Floats]) -> dict[str, Exact]:
    """Exact multipliers near the solver's floats ``found`` (in the order of the constraints) that pass the check.

    Raises
    ------
    ProofFailedError: if none could be made.
    """
    constraints = _exact_constraints(theorem, model)
    floats = theorem.constraints(theorem.data(model, bound="low"), theorem.unknowns(model).probes())
    multipliers = _exact_multipliers(constraints, floats, found)
    if multipliers is None:
        raise ProofFailedError("the solver's multipliers could not be made exact")
    _check(constraints, multipliers)
    return multipliers


def _exact_multipliers(
    constraints: Sequence[Constraint], floats: Sequence[Constraint], found: Sequence[Floats]
) -> dict[str, Exact] | None:
    """Each is pushed into the cone a little; then as many entries as there are unknowns, in the blocks with most room,
    are changed so that the equations hold exactly."""
    scale = max(float(np.abs(Z).max()) for Z in found)
    if not (scale > 0.0 and np.isfinite(scale)):
        return None
    exact, room = [], []
    for Z in found:
        size = Z.shape[-1]
        normal = 0.5 * (Z + np.swapaxes(Z, -1, -2)) / scale + _PUSH * np.eye(size)
        # Multipliers have no scale: whole numbers keep exact sums short.
        exact.append(exact_array(np.round(normal * _WHOLE)))
        room.append(np.linalg.eigvalsh(normal).min(axis=-1))
    _, residual = _pairing(constraints, exact)
    columns, places = _columns(floats)
    weights = np.array([room[family][block] for family, block, _, _ in places])
    chosen = _pivots(columns, weights)
    if chosen is None:
        return None
    square = np.stack([_column(constraints, places[index]) for index in chosen], axis=1)
    try:
        change = solve_exact(square, -residual)
    except ArgumentError:
        return None
    for value, index in zip(change, chosen, strict=True):
        family, block, row, column = places[index]
        exact[family][block, row, column] += value
        if row != column:
            exact[family][block, column, row] += value
    return {constraint.name: Z for constraint, Z in zip(constraints, exact, strict=True)}


def _exact_constraints(theorem: Theorem, model: Model) -> Sequence[Constraint]:
    data = theorem.data(model, exact=True, bound="low")
    return theorem.constraints(data, theorem.unknowns(model).exact_probes())


def _pairing(constraints: Sequence[Constraint], multipliers: Sequence[Exact]) -> tuple[Any, Exact]:
    """sum_k <Z_k, F_k0> and sum_k <Z_k, F_ki> for all i."""
    total: Any = rational(0)
    for constraint, Z in zip(constraints, multipliers, strict=True):
        total = total + constraint.matrices.reshape(len(constraint.matrices), -1) @ Z.ravel()
    return total[0], total[1:] - total[0]


Place = tuple[int, int, int, int]


def _column(constraints: Sequence[Constraint], place: Place) -> Exact:
    """Exact coefficients of one entry of a multiplier, and of the one across, in all equations."""
    family, block, row, column = place
    entries = constraints[family].matrices[:, block, row, column]
    linear: Exact = entries[1:] - entries[0]
    return linear if row == column else 2 * linear


def _columns(constraints: Sequence[Constraint]) -> tuple[Floats, list[Place]]:
    """The equations' coefficients (unknowns, entries) in floats, and where each entry of a multiplier is."""
    parts, places = [], []
    for family, constraint in enumerate(constraints):
        linear = constraint.matrices[1:] - constraint.matrices[0]
        row, column = np.triu_indices(linear.shape[-1])
        entries = linear[..., row, column]
        entries[..., row != column] = 2 * entries[..., row != column]
        parts.append(entries.reshape(len(linear), -1))
        places += [
            (family, block, int(r), int(c))
            for block in range(linear.shape[1])
            for r, c in zip(row, column, strict=True)
        ]
    return np.concatenate(parts, axis=1), places


def _pivots(columns: Floats, weights: Floats) -> list[int] | None:
    """Columns that span the equations, preferring large weights and columns with a single non-zero."""
    lone = (columns != 0.0).sum(axis=0) == 1
    alone = np.abs(columns) * np.where(lone, weights, 0.0)
    if (alone.max(axis=1) > 0.0).all():
        # Every unknown has a multiplier of its own, as P_r has in P_r > 0.
        return [int(place) for place in alone.argmax(axis=1)]
    work = columns * np.where(lone, 1e3 * weights, weights)
    chosen: list[int] = []
    floor = 1e-12 * float(np.abs(work).max(initial=0.0))
    for _ in range(len(columns)):
        norms = (work * work).sum(axis=0)
        best = int(norms.argmax())
        if not norms[best] > floor * floor:
            return None
        direction = work[:, best] / np.sqrt(norms[best])
        work = work - np.outer(direction, direction @ work)
        chosen.append(best)
    return chosen
