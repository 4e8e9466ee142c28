"""The largest decay rate that a theorem can prove."""

from dataclasses import replace

import numpy as np

from robust_core.analysis.decide import Result, decide
from robust_core.checks import finite_number
from robust_core.errors import ArgumentError
from robust_core.lmi.margin import MarginSolver
from robust_core.models import PolytopicSystem
from robust_core.rational import rational, to_float
from robust_core.theorems.lyapunov import LyapunovTheorem
from robust_core.verdict import Verdict

_GOOD = (Verdict.PROVEN, Verdict.SUPPORTED)


def largest_decay(
    theorem: LyapunovTheorem, model: PolytopicSystem, *, relative: float = 1e-4, solver: MarginSolver | None = None
) -> tuple[float, Result]:
    """The largest rate a (1/s) with V' < -2 a V by the theorem, and the proof of it.

    Bisection between the theorem's own decay and the slowest mode of the vertices; the rate returned is one that was
    proven, within ``relative`` of one that was not. If even the theorem's own decay fails, its result is returned.
    """
    finite_number("relative", relative, low=1e-9, high=0.5)
    if not isinstance(theorem, LyapunovTheorem):
        raise ArgumentError("theorem", "one on stability", type(theorem).__name__)
    shared = solver or MarginSolver()
    low = float(to_float(np.array(rational(theorem.decay), dtype=object)))
    best = decide(theorem, model, solver=shared)
    if best.verdict not in _GOOD:
        return low, best
    slowest = -float(np.linalg.eigvals(model.attained().A).real.max())
    high = max(slowest, low) * (1.0 + relative)
    while high - low > relative * high:
        middle = 0.5 * (low + high)
        result = decide(replace(theorem, decay=middle), model, solver=shared)
        if result.verdict in _GOOD:
            low, best = middle, result
        else:
            high = middle
    return low, best
