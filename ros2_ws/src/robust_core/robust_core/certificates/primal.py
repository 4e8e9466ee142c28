"""Checks of a solution of a theorem's inequalities."""

import math
from collections.abc import Mapping

import numpy as np

from robust_core.errors import ProofFailedError
from robust_core.lmi.coefficients import coefficients
from robust_core.lmi.unknowns import Values
from robust_core.rational import Floats, definite, exact_array
from robust_core.theorems.base import Model, Theorem


def check_exact(theorem: Theorem, model: Model, values: Values) -> None:
    """Every inequality holds at the exact values of the floats in ``values``, with the upper bounds of the rates.

    Raises
    ------
    ProofFailedError: naming the first inequality that does not.
    """
    data = theorem.data(model, exact=True, bound="high")
    exact = {name: exact_array(value) for name, value in values.items()}
    for constraint in theorem.constraints(data, exact):
        good = definite(constraint.matrices, strict=constraint.strict)
        if not good.all():
            raise ProofFailedError(
                f"{constraint.name} does not hold exactly in block {int(np.argmin(good))} of {good.size}"
            )


def float_margins(theorem: Theorem, model: Model, values: Values) -> dict[str, float]:
    """Least eigenvalue of every inequality's blocks, less what rounding may have added.

    Eigenvalues are those of blocks scaled to a unit diagonal of terms, so that badly scaled models are judged alike.
    """
    unknowns = theorem.unknowns(model)
    data = theorem.data(model, bound="high")
    vector = np.asarray(unknowns.pack(values), dtype=np.float64)
    return {
        family.name: scaled_margin(family.at(vector), family.magnitude(vector))
        for family in coefficients(unknowns, lambda probes: theorem.constraints(data, probes))
    }


def check_float(theorem: Theorem, model: Model, values: Values) -> Mapping[str, float]:
    """The margins of :func:`float_margins`; those of strict inequalities are positive.

    Raises
    ------
    ProofFailedError: naming the first inequality that does not hold.
    """
    margins = float_margins(theorem, model, values)
    for name, margin in margins.items():
        if not margin > 0.0:
            raise ProofFailedError(f"{name} does not hold in floating point: its least eigenvalue is {margin:.3g}")
    return margins


def scaled_margin(matrices: Floats, magnitude: Floats) -> float:
    """Least eigenvalue over matrices (K, n, n) after scaling the diagonal of ``magnitude`` to 1, minus rounding."""
    diagonal = np.diagonal(magnitude, axis1=-2, axis2=-1)
    if (diagonal <= 0.0).any():
        return -math.inf
    scale = 1.0 / np.sqrt(diagonal)
    outer = scale[:, :, None] * scale[:, None, :]
    size = matrices.shape[-1]
    rounding = 64.0 * 2.0**-52 * size * max(1.0, float((magnitude * outer).max()))
    return float(np.linalg.eigvalsh(matrices * outer).min() - rounding)
