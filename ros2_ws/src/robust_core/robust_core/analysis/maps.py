"""Maps: one theorem asked about many models of one shape."""

from collections import defaultdict
from collections.abc import Sequence
from typing import Any

import numpy as np

from robust_core.analysis.decide import Result, conclude_feasible, conclude_infeasible, decide
from robust_core.errors import RobustCoreError
from robust_core.lmi.barrier import Stack, best_margins
from robust_core.lmi.conic import ConicSolution
from robust_core.lmi.small_matrices import least_eigenvalue
from robust_core.rational import Floats
from robust_core.theorems.base import Theorem
from robust_core.verdict import Verdict

_CHUNK = 512


def decide_many(theorem: Theorem, models: Sequence[Any], *, exact: bool = True) -> list[Result]:
    """Verdicts on all models, solved together; what stays open is asked again one by one.

    A model on which a theorem cannot be asked, or the solver fails, gets the verdict "undecided" with the reason.
    """
    results: list[Result | None] = [None] * len(models)
    alike: dict[Any, list[int]] = defaultdict(list)
    for place, model in enumerate(models):
        try:
            special = theorem.specialised(model)
            alike[special, special.unknowns(model)].append(place)
        except RobustCoreError as error:
            results[place] = _failed(error)
    for (special, _), places in alike.items():
        for start in range(0, len(places), _CHUNK):
            part = places[start : start + _CHUNK]
            for place, result in zip(part, _together(special, [models[k] for k in part], exact), strict=True):
                results[place] = result
    return [_again(theorem, model, result, exact) for model, result in zip(models, results, strict=True)]


def _again(theorem: Theorem, model: Any, result: Result | None, exact: bool) -> Result:
    if result is not None:
        return result
    try:
        return decide(theorem, model, exact=exact)
    except RobustCoreError as error:
        return _failed(error)


def _failed(error: RobustCoreError) -> Result:
    return Result(Verdict.UNDECIDED, f"{type(error).__name__}: {error}", float("nan"))


def _together(theorem: Theorem, models: Sequence[Any], exact: bool) -> list[Result | None]:
    """Verdicts where the barrier's answer can be proven, None elsewhere."""
    unknowns = theorem.unknowns(models[0])
    data = stacked_data(theorem, models)
    stacks, names = [], tuple(c.name for c in theorem.constraints(theorem.data(models[0]), unknowns.probes()))
    for constraint in theorem.constraints(data, unknowns.probes()):
        values = np.broadcast_to(constraint.matrices, (len(models), *constraint.matrices.shape[-4:]))
        stacks.append(Stack(values[:, 1:] - values[:, :1], constraint.weight, constraint.sized))
    with np.errstate(all="ignore"):
        try:
            found = best_margins(stacks)
        except np.linalg.LinAlgError:
            return [None] * len(models)
    out: list[Result | None] = []
    least = np.stack([_least(stack, found.vectors) for stack in stacks], axis=1).tolist()
    for k, model in enumerate(models):
        lower, upper = float(found.lower[k]), float(found.upper[k])
        multipliers = tuple(Z[k] for Z in found.multipliers)
        solution = ConicSolution(found.vectors[k], lower, multipliers, lower, "batch", 0, tuple(least[k]))
        result = None
        if lower > 0.0:
            result = conclude_feasible(theorem, model, solution, names, exact=exact)
        elif upper < 0.0:
            result = conclude_infeasible(theorem, model, solution, exact=exact)
        out.append(None if result is None or (exact and result.certificate is None) else result)
    return out


def _least(stack: Stack, vectors: Floats) -> Floats:
    """Least eigenvalues (N,) of one constraint at y, less what rounding may have added."""
    shape = (len(vectors), *stack.linear.shape[2:])
    flat = stack.linear.reshape(*stack.linear.shape[:2], -1)
    values = np.matmul(vectors[:, None, :], flat).reshape(shape)
    sizes = np.matmul(np.abs(vectors)[:, None, :], np.abs(flat))[:, 0].max(axis=1)
    return np.asarray(least_eigenvalue(values).min(axis=1) - 64.0 * 2.0**-52 * shape[-1] * sizes)


def stacked_data(theorem: Theorem, models: Sequence[Any]) -> dict[str, Floats]:
    """The models' arrays along a first axis, with a second one for the probes; what they share stays as it is."""
    all_data = [theorem.data(model) for model in models]
    common = {"totals", "mixing", "half", "decay", "L", "M"}
    return {
        key: value if key in common else np.stack([np.asarray(data[key]) for data in all_data])[:, None]
        for key, value in all_data[0].items()
    }
