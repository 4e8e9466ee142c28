"""A terminal weight and set: with u = K x the stage cost is paid by the descent of the weight, (5.2.21)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.errors import ArgumentError
from robust_core.lmi import Constraint, Unknown, Unknowns
from robust_core.lmi.constraint import blocks, transpose
from robust_core.lmi.unknowns import Values
from robust_core.rational import definite
from robust_core.theorems.base import Data, Theorem
from robust_core.theorems.options import MatrixOption, option_array


@dataclass(frozen=True)
class TerminalIngredient(Theorem):
    """P > 0 and w > 0 with (A_i + B_i K)' P (A_i + B_i K) < P - Q - K'R K, and |c x| < b in {x'P x <= 1 / w}.

    Options: ``gain`` K (r, n), ``Q`` (n, n), ``R`` (r, r), ``rows`` c (k, n) and ``bounds`` b (k,). The set is
    invariant under u = K x, which keeps the inputs' limits and the ones that the vertices are valid for; in it V = x'P
    x satisfies V(x+) - V(x) < -(x'Q x + u'R u) <= -lambda_min(Q) |x|^2.
    """

    NAME = "terminal ingredient"
    PROVES = "descent of the terminal weight by the stage cost inside an invariant set within the limits"
    gain: MatrixOption
    Q: MatrixOption
    R: MatrixOption
    rows: MatrixOption
    bounds: MatrixOption

    def specialised(self, model: Any) -> "TerminalIngredient":
        """Itself; ArgumentError where weights or limits do not fit."""
        if model.B is None:
            raise ArgumentError("model", "a system with inputs", "one without B")
        n, r, k = model.states, model.B.shape[2], len(self.rows)
        shapes = {"gain": (r, n), "Q": (n, n), "R": (r, r), "rows": (k, n), "bounds": (k,)}
        for name, wanted in shapes.items():
            shape = option_array(getattr(self, name), exact=False).shape
            if shape != wanted:
                raise ArgumentError(name, f"of shape {wanted}", f"shape {shape}")
        for name in ("Q", "R"):
            matrix = option_array(getattr(self, name), exact=True)
            if not (matrix == matrix.T).all() or not definite(matrix, strict=False):
                raise ArgumentError(name, "symmetric and positive semidefinite", repr(getattr(self, name)))
        return self

    def data(self, model: Any, *, exact: bool = False, bound: str = "high") -> Data:
        """The closed loop's vertices, the stage cost under the gain, and the limits."""
        data = dict(super().data(model, exact=exact, bound=bound))
        K, Q, R, rows, bounds = (
            option_array(option, exact=exact) for option in (self.gain, self.Q, self.R, self.rows, self.bounds)
        )
        return data | {"loop": data["A"] + data["B"] @ K, "stage": Q + K.T @ R @ K, "rows": rows, "bounds": bounds}

    def unknowns(self, model: Any) -> Unknowns:
        """P (n, n), w and s, which scales Q and R."""
        return Unknowns((Unknown("P", model.states, symmetric=True), Unknown("w", 1), Unknown("s", 1)))

    def constraints(self, data: Data, values: Values) -> Sequence[Constraint]:
        """P > 0, the descent and the limits."""
        P, w, s = (values[name][..., None, :, :] for name in ("P", "w", "s"))
        loop, rows = data["loop"], data["rows"][:, None, :]
        after = transpose(loop) @ P @ loop
        squared = (data["bounds"] * data["bounds"])[:, None, None]
        within = blocks([[P, s * transpose(rows)], [s * rows, w * squared]])
        return (
            Constraint("P > 0", P, sized=True),
            Constraint("descent", P - after - s * data["stage"]),
            Constraint("within limits", within),
        )

    @staticmethod
    def level(values: Values) -> tuple[Any, float]:
        """P (n, n) and level c of the certified set {x'P x <= c}, both in units of the stage cost."""
        w, s = (float(np.ravel(values[name])[0]) for name in ("w", "s"))
        return values["P"] / s, s / w
