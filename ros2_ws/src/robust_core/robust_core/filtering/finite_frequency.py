"""The gain of a filter's error over a band of frequencies, by the generalised Kalman-Yakubovich-Popov lemma.

For |w| in [w1, w2] and every frozen weight sigma the error's gain is below gamma if there are Hermitian P_i and
Q_i > 0 and a slack G with, w_c = (w1 + w2) / 2,

    [-Q_i, P_i + j w_c Q_i, 0; *, -w1 w2 Q_i + C'C, C'D; *, *, D'D - gamma^2 I] + He(G [-I, A_i, B_i]) < 0.

The slack makes it affine in the vertices, so P and Q may follow sigma. A varying sigma has no frequency response: for
that the same certificate holds one common V > 0, which proves stability, and the frozen poles in a region if asked.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.errors import ArgumentError
from robust_core.filtering.complex_form import ComplexForm, complex_blocks, hermitian, real_form
from robust_core.filtering.filter import Filter, error_matrices
from robust_core.filtering.theorem_3_1 import plain_filter, plain_region, region_from_json
from robust_core.lmi import Constraint, Unknown, Unknowns, he
from robust_core.lmi.constraint import blocks, transpose
from robust_core.lmi.unknowns import Values
from robust_core.rational import exact_array, rational, to_float
from robust_core.theorems.base import Data, Theorem, exact_option
from robust_core.theorems.d_stability import kronecker
from robust_core.theorems.regions import Region


@dataclass(frozen=True)
class FiniteFrequencyFilter(Theorem):
    """Gain below ``gamma`` for w in [``low``, ``high``] rad/s, stability, and the region of the frozen poles."""

    NAME = "finite frequency"
    PROVES = "the gain of the frozen filtering error over the band, its stability and the region of its frozen poles"
    filtering: Filter
    low: Any
    high: Any
    gamma: Any
    region: Region | None = None

    def __post_init__(self) -> None:
        for name in ("low", "high", "gamma"):
            object.__setattr__(self, name, exact_option(name, getattr(self, name)))
        if not 0 <= rational(self.low) < rational(self.high):
            raise ArgumentError("low", "at least 0 and below high", f"{self.low} and {self.high}")
        if rational(self.gamma) <= 0:
            raise ArgumentError("gamma", "positive", self.gamma)

    def specialised(self, model: Any) -> "FiniteFrequencyFilter":
        """Itself; ArgumentError where the filter does not fit the plant."""
        self.filtering.check(model)
        return self

    def data(self, model: Any, *, exact: bool = False, bound: str = "high") -> Data:
        """The error system, the band and the gain."""
        data = dict(super().data(model, exact=exact, bound=bound))
        data["error"] = error_matrices(data, self.filtering, exact=exact)
        low, high, gamma = rational(self.low), rational(self.high), rational(self.gamma)
        center = (low + high) / 2
        numbers = exact_array([center, low * high / (center * center), gamma * gamma])
        data["band"] = list(numbers if exact else to_float(numbers))
        if self.region is not None:
            L, M = self.region.matrices
            data["L"], data["M"] = (L, M) if exact else (to_float(L), to_float(M))
        return data

    def unknowns(self, model: Any) -> Unknowns:
        """P, Q (m, N, N) as n^2 numbers of Hermitian matrices, G (2 N + w, N) twice, V (N, N) and s."""
        size, m = model.sizes["x"] + self.filtering.order, model.count
        rows = 2 * size + model.sizes["w"]
        return Unknowns(
            (
                Unknown("P", size, count=m),
                Unknown("Q", size, count=m),
                Unknown("G", rows, size, count=2),
                Unknown("V", size, symmetric=True),
                Unknown("s", 1),
            )
        )

    def constraints(self, data: Data, values: Values) -> Sequence[Constraint]:
        """Q_i > 0, the lemma at the vertices, and stability."""
        A, B, C, D = data["error"]
        s = values["s"][..., None, :, :]
        center, product, squared = data["band"]
        # Time in units of 1 / w_c: the band is around 1 rad then, and the numbers are of one size.
        slow = 1 / center
        P, Q = hermitian(values["P"]), hermitian(values["Q"])
        slack = ComplexForm(values["G"][..., 0, None, :, :], values["G"][..., 1, None, :, :])
        motion = blocks([[-_identity(A), slow * A, slow * B]])
        pushed = ComplexForm(slack.real @ motion, slack.imaginary @ motion)
        gain = he(transpose(D) @ D) * data["half"] - squared * _identity(B, columns=True)
        lemma = frequency_form(P, Q, product, s * (transpose(C) @ C), s * (transpose(C) @ D), s * gain)
        whole = lemma + pushed + pushed.adjoint
        V = values["V"][..., None, :, :]
        flow = V @ A
        found = [
            Constraint("Q > 0", Q.embedded(), sized=True),
            Constraint("gain in the band", -whole.embedded()),
            Constraint("V > 0", V, sized=True),
            Constraint("stability", -he(flow)),
            Constraint("s > 0", s),
        ]
        if self.region is not None:
            inside = kronecker(data["L"], V) + kronecker(data["M"], flow)
            found.append(Constraint("poles", -inside - kronecker(transpose(data["M"]), transpose(flow))))
        return found

    def to_json(self) -> dict[str, Any]:
        """Name and options as plain data."""
        options = {
            "filtering": plain_filter(self.filtering),
            "low": self.low,
            "high": self.high,
            "gamma": self.gamma,
            "region": plain_region(self.region),
        }
        return {"name": self.NAME, "options": options}

    @classmethod
    def options_from_json(cls, options: Mapping[str, Any]) -> dict[str, Any]:
        """Keyword arguments from plain options."""
        f = options["filtering"]
        numbers = {name: options[name] for name in ("low", "high", "gamma")}
        region = None if options["region"] is None else region_from_json(options["region"])
        return {**numbers, "filtering": Filter.of(f["A"], f["B"], f["C"]), "region": region}


def frequency_form(P: ComplexForm, Q: ComplexForm, product: Any, state: Any, cross: Any, gain: Any) -> ComplexForm:
    """The lemma's matrix in (x', x, w) without the slack, for w_c = 1 and w1 w2 = ``product``.

    ``state`` is C'C, ``cross`` C'D, ``gain`` D'D - gamma^2 I.
    """
    edge = P + Q.turned(1)
    middle = Q.scaled(-product) + real_form(state)
    return complex_blocks(
        [
            [-Q, edge, None],
            [edge.adjoint, middle, real_form(cross)],
            [None, real_form(transpose(cross)), real_form(gain)],
        ]
    )


def _identity(matrix: Any, *, columns: bool = False) -> Any:
    """An identity of the size of the matrix's rows (or columns), in its kind of numbers."""
    size = matrix.shape[-1 if columns else -2]
    unit = np.eye(size)
    return exact_array(unit) if matrix.dtype == object else unit
