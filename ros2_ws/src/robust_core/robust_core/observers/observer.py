"""Observers z+ = N z + R u + L y + M D_f f(x^), x^ = z - E y of (4.3.3), and whether their residual sees a fault."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.errors import ArgumentError
from robust_core.models.lipschitz_plant import LipschitzPlant
from robust_core.rational import Floats, all_zero, exact_array
from robust_core.theorems.options import MatrixOption, matrix_option, option_array


class BlindObserverError(ArgumentError):
    """The residual of the observer does not depend on the fault, whatever the fault."""


@dataclass(frozen=True, slots=True)
class FaultObserver:
    """Exact gains E (n, y) and X (n, y) as nested texts; everything else follows by (4.3.7)."""

    E: MatrixOption
    X: MatrixOption

    @staticmethod
    def of(E: Any, X: Any) -> "FaultObserver":
        """An observer from its gains.

        Raises
        ------
        ArgumentError: for gains of different shapes or not finite.
        """
        return FaultObserver(matrix_option("E", E, (None, None)), matrix_option("X", X, np.shape(np.asarray(E))))

    def matrices(self, plant: LipschitzPlant, *, exact: bool = False) -> dict[str, Any]:
        """M = I + E C, N = M A - X C, R = M B, L = X (I + C E) - M A E."""
        data = plant.data(exact=exact)
        E, X = option_array(self.E, exact=exact), option_array(self.X, exact=exact)
        if E.shape != (plant.states, data["C"].shape[0]):
            raise ArgumentError("E", f"of shape {(plant.states, data['C'].shape[0])}", f"shape {E.shape}")
        A, C = data["A"], data["C"]
        unit = np.eye(plant.states)
        M = (exact_array(unit) if exact else unit) + E @ C
        inner = np.eye(len(C))
        gain = X @ ((exact_array(inner) if exact else inner) + C @ E) - M @ A @ E
        return {"E": E, "X": X, "M": M, "N": M @ A - X @ C, "R": M @ data["B"], "L": gain}

    def is_blind(self, plant: LipschitzPlant) -> bool:
        """Whether C (zI - N)^-1 M D is identically zero, decided exactly: M D != 0 does not suffice (erratum 4.3.6)."""
        found, data = self.matrices(plant, exact=True), plant.data(exact=True)
        reached = found["M"] @ data["D"]
        for _ in range(plant.states):
            if not all_zero((data["C"] @ reached).ravel()):
                return False
            reached = found["N"] @ reached
        return True

    def fault_gain(self, plant: LipschitzPlant, radians_per_step: Any) -> Floats:
        """|C (zI - N)^-1 M D| at z = exp(i w), from the fault to the residual, for w (...,); largest singular value."""
        found, data = self.matrices(plant), plant.data()
        z = np.exp(1j * np.asarray(radians_per_step, dtype=np.float64))[..., None, None]
        inner = np.linalg.solve(z * np.eye(plant.states) - found["N"], found["M"] @ data["D"] + 0.0 * z)
        return np.asarray(np.linalg.norm(data["C"] @ inner, 2, axis=(-2, -1)))
