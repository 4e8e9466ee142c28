"""What is claimed of vertex gains u = sum_j sigma_j K_j x: decay, poles, inputs and states within limits."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.errors import ArgumentError
from robust_core.lmi import Constraint, Unknown, Unknowns, he
from robust_core.lmi.constraint import blocks, transpose
from robust_core.lmi.unknowns import Values
from robust_core.rational import rational, to_float
from robust_core.theorems.base import Data
from robust_core.theorems.d_stability import kronecker
from robust_core.theorems.lyapunov import LyapunovTheorem
from robust_core.theorems.options import MatrixOption, matrix_option, option_array
from robust_core.theorems.regions import Region


@dataclass(frozen=True)
class ClosedLoop(LyapunovTheorem):
    """One P > 0 for x' = sum_ij sigma_i sigma_j (A_i + B_i K_j) x, on pairs i <= j where the B_i differ.

    Options beside the decay rate: ``gains`` (m, r, n); an LMI region ``L``, ``M`` for the frozen poles;
    ``input_limit`` (r,), ``box`` rows (k, n) and ``box_limit`` (k,) for |c x| <= b, ``start`` points (p, n). With
    limits the ellipsoid x'P x <= s holds all start points, is never left, and inside it no limit is reached: the claim
    covers the saturated loop, because it never saturates.
    """

    NAME = "closed loop"
    PROVES = "exponential stability under the gains, within the stated limits from the stated starts"
    gains: MatrixOption = ()
    region: str = ""
    L: MatrixOption = ()
    M: MatrixOption = ()
    input_limit: MatrixOption = ()
    box: MatrixOption = ()
    box_limit: MatrixOption = ()
    start: MatrixOption = ()

    @staticmethod
    def of(
        gains: Any,
        *,
        decay: Any = 0,
        region: Region | None = None,
        input_limit: Any = None,
        box: Any = None,
        box_limit: Any = None,
        start: Any = None,
    ) -> "ClosedLoop":
        """The claim from arrays.

        Raises
        ------
        ArgumentError: for arrays of other shapes, or limits that are not positive.
        """
        options: dict[str, Any] = {"gains": matrix_option("gains", gains, (None, None, None))}
        if region is not None:
            options |= {"region": region.name, "L": region.L, "M": region.M}
        for name, value, shape in (
            ("input_limit", input_limit, (None,)),
            ("box", box, (None, None)),
            ("box_limit", box_limit, (None,)),
            ("start", start, (None, None)),
        ):
            if value is not None:
                options[name] = matrix_option(name, value, shape)
        return ClosedLoop(decay=decay, **options)

    def __post_init__(self) -> None:
        LyapunovTheorem.__post_init__(self)
        for name in ("input_limit", "box_limit"):
            if any(rational(value) <= 0 for value in getattr(self, name)):
                raise ArgumentError(name, "positive", repr(getattr(self, name)))
        if len(self.box) != len(self.box_limit):
            raise ArgumentError("box_limit", f"one limit for each of {len(self.box)} rows", str(len(self.box_limit)))

    @property
    def limited(self) -> bool:
        """Whether the claim has limits or starts, hence an ellipsoid of its own size."""
        return bool(self.input_limit or self.box or self.start)

    def specialised(self, model: Any) -> "ClosedLoop":
        """Itself; ArgumentError where the gains do not fit the model."""
        if model.B is None:
            raise ArgumentError("model", "a system with inputs", "one without B")
        wanted = (model.count, model.B.shape[2], model.states)
        shape = np.shape(np.array(self.gains, dtype=object))
        if shape != wanted:
            raise ArgumentError("gains", f"of shape {wanted}", f"shape {shape}", "one gain (r, n) per vertex")
        if self.input_limit and len(self.input_limit) != wanted[1]:
            raise ArgumentError("input_limit", f"{wanted[1]} limits, one per input", str(len(self.input_limit)))
        for name in ("box", "start"):
            if any(len(row) != model.states for row in getattr(self, name)):
                raise ArgumentError(name, f"rows of {model.states} numbers", repr(getattr(self, name)))
        return self

    def data(self, model: Any, *, exact: bool = False, bound: str = "high") -> Data:
        """The closed loop's matrices, on pairs where needed, and the limits."""
        data = dict(super().data(model, exact=exact, bound=bound))
        gains = option_array(self.gains, exact=exact)
        data["gains"] = gains
        data["loop"] = closed_loop_matrices(data["A"], data["B"], gains, data["half"])
        for name in ("L", "M", "input_limit", "box", "box_limit", "start"):
            option = getattr(self, name)
            if option:
                data[name] = option_array(option, exact=exact)
        return data

    def unknowns(self, model: Any) -> Unknowns:
        """P (n, n), and the size s of the ellipsoid where there are limits."""
        lyapunov = Unknown("P", model.states, symmetric=True)
        return Unknowns((lyapunov, Unknown("s", 1)) if self.limited else (lyapunov,))

    def constraints(self, data: Data, values: Values) -> Sequence[Constraint]:
        """P > 0, the decay, the poles and the limits."""
        P = values["P"][..., None, :, :]
        flow = P @ data["loop"]
        found = [Constraint("P > 0", P, sized=True), Constraint("decay", -he(flow) - 2 * data["decay"] * P)]
        if self.L:
            inside = kronecker(data["L"], P) + kronecker(data["M"], flow)
            found.append(Constraint("region", -inside - kronecker(transpose(data["M"]), transpose(flow))))
        if not self.limited:
            return found
        size = values["s"][..., None, :, :]
        if self.input_limit:
            rows = data["gains"].reshape(-1, 1, P.shape[-1])
            limits = np.tile(data["input_limit"], len(data["gains"]))
            found.append(Constraint("inputs within limits", _within(P, size, rows, limits)))
        if self.box:
            found.append(
                Constraint("states within limits", _within(P, size, data["box"][:, None, :], data["box_limit"]))
            )
        if self.start:
            points = data["start"][:, None, :]
            found.append(Constraint("start inside", size - points @ P @ transpose(points)))
        return found

    def vertex_matrices(self, model: Any, values: Values) -> Any:
        """The same P at every vertex."""
        return values["P"][..., None, :, :].repeat(model.count, axis=-3)


def closed_loop_matrices(A: Any, B: Any, K: Any, half: Any) -> Any:
    """A_i + B_i K_i where all B_i are equal; else the means of (i, j) and (j, i) for all pairs i <= j."""
    if all((B[0] == matrix).all() for matrix in B):
        return A + B @ K
    first, second = np.triu_indices(len(A))
    one, other = A[first] + B[first] @ K[second], A[second] + B[second] @ K[first]
    return half * (one + other)


def _within(P: Any, size: Any, rows: Any, limits: Any) -> Any:
    """|c x| <= b wherever x'P x <= s: [P, s c'; s c, s b^2] > 0 for rows c (k, 1, n)."""
    squared = (limits * limits)[:, None, None]
    return blocks([[P + 0 * (size * squared), size * transpose(rows)], [size * rows, size * squared]])


def gains_as_floats(theorem: ClosedLoop) -> Any:
    """The claimed gains (m, r, n)."""
    return to_float(option_array(theorem.gains, exact=True))
