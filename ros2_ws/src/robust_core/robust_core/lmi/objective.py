"""The least of a linear or convex quadratic function of the unknowns under LMIs."""

from collections.abc import Sequence

import numpy as np

from robust_core.errors import ArgumentError
from robust_core.lmi.coefficients import Family
from robust_core.lmi.conic import ConicProblem, ConicSolution
from robust_core.lmi.large_blocks import minimise_large, pays
from robust_core.lmi.settings import SolverSettings
from robust_core.rational import Floats


def minimise(
    families: Sequence[Family],
    *,
    linear: Floats | None = None,
    quadratic: Floats | None = None,
    settings: SolverSettings | None = None,
) -> ConicSolution:
    """min linear . y + 1/2 y . quadratic y subject to F_k(y) >= 0.

    No strictness margin is added: the optima of the thesis's problems are very sensitive to one. Solve, then verify.

    Raises
    ------
    ArgumentError: for an objective of another size.
    SolverError: if the solver failed, which includes LMIs without a solution and objectives without a minimum.
    """
    size = families[0].linear.shape[0]
    if linear is None and quadratic is None:
        raise ArgumentError("linear", "given, or quadratic", "neither")
    if linear is not None and np.shape(linear) != (size,):
        raise ArgumentError("linear", f"of shape ({size},)", f"shape {np.shape(linear)}")
    if quadratic is not None and np.shape(quadratic) != (size, size):
        raise ArgumentError("quadratic", f"of shape ({size}, {size})", f"shape {np.shape(quadratic)}")
    chosen = settings or SolverSettings()
    if linear is not None and quadratic is None and pays(families):
        found = minimise_large(families, np.asarray(linear, dtype=np.float64), chosen)
        if found is not None:
            return found
    problem = ConicProblem.shaped(families, with_margin=False, with_size=False)
    return problem.solve(families, settings=chosen, linear=linear, quadratic=quadratic)
