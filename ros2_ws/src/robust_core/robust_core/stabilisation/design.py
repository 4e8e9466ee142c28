"""The result of a stabilising design."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.analysis import Result
from robust_core.lmi.conic import ConicSolution
from robust_core.rational import Floats, exact_array, to_float


@dataclass(frozen=True, slots=True)
class Design:
    """Vertex gains ``K`` (m, r, n), u = sum_j sigma_j K_j x, and the ``result`` that says what is proven of them."""

    name: str
    K: Floats
    result: Result
    status: str
    iterations: int

    def ellipsoid(self) -> Floats:
        """P (n, n) of the invariant set {x'P x <= 1} of a design with limits; the certificate's numbers."""
        values = self.result.require(proven=False).values or {}
        size = float(np.ravel(values["s"])[0]) if "s" in values else 1.0
        return np.asarray(values["P"] / size)


def conclude(name: str, claim: Any, result: Result, found: ConicSolution) -> Design:
    """The design with the gains that were claimed, as the floats nearest to them."""
    return Design(name, to_float(exact_array(claim.gains)), result, found.status, found.iterations)
