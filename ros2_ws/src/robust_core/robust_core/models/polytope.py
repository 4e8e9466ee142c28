"""Polytopic systems x' = sum_r sigma_r(x) (A_r x + B_r u), (2.1.5)."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from robust_core.checks import finite_array
from robust_core.errors import ArgumentError, RateError
from robust_core.models.rates import RateBounds
from robust_core.models.simplices import Simplices
from robust_core.rational import Exact, Floats, exact_array, to_float, to_text

Data = Mapping[str, Any]
"""Arrays that a theorem's formulas take, all floats or all exact."""


def digest_of(content: Any) -> str:
    """SHA-256 of plain data in canonical JSON."""
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()


def _exact(name: str, values: Any, shape: tuple[int | None, ...], remedy: str) -> Exact:
    try:
        source = np.asarray(values)
    except ValueError as error:
        raise ArgumentError(name, "an array of numbers", "rows of different lengths", remedy) from error
    if source.dtype.kind in "fiub":
        return exact_array(finite_array(name, source, shape, remedy))
    exact = exact_array(source)
    finite_array(name, to_float(exact), shape, remedy)
    return exact


@dataclass(frozen=True, slots=True)
class PolytopicSystem:
    """Vertices with what is known of their weights. Build it with :meth:`of`.

    ``exact_state_matrices`` (m, n, n) and ``exact_input_matrices`` (m, n, r) or None hold exact numbers, ``A`` and
    ``B`` the nearest floats; ``simplices`` says which weights sum to what; ``rates`` bounds their rates, or is None
    where no theorem needs it.
    """

    exact_state_matrices: Exact
    exact_input_matrices: Exact | None
    simplices: Simplices
    rates: RateBounds | None
    A: Floats = field(init=False, repr=False)
    B: Floats | None = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "A", to_float(self.exact_state_matrices))
        object.__setattr__(
            self, "B", None if self.exact_input_matrices is None else to_float(self.exact_input_matrices)
        )

    @staticmethod
    def of(
        A: Any,
        B: Any = None,
        *,
        groups: Sequence[Sequence[int]] | None = None,
        totals: Sequence[Any] | None = None,
        rates: RateBounds | Any = None,
    ) -> "PolytopicSystem":
        """A checked model.

        Parameters
        ----------
        A: (m, n, n) state matrices, one per weight; floats (taken at their exact binary value), or integers, Fractions
            and texts ("-10/7", "0.6") for exact ones.
        B: (m, n, r) or, where all are equal, (n, r) input matrices.
        groups, totals: which weights sum to what; one simplex unless given.
        rates: :class:`RateBounds`, or (m,) numbers phi_r that the caller vouches for.

        >>> model = PolytopicSystem.of([[["-1", 0], [0, -2]], [[-3, "1/3"], [0, -1]]], rates=[0.1, 0.1])
        >>> model.states, model.count, model.digest[:8]
        (2, 2, '...')

        Raises
        ------
        ArgumentError: naming the argument, its expected shape and what to try.
        """
        matrices = _exact("A", A, (None, None, None), "stack one square matrix per vertex")
        count, states = matrices.shape[:2]
        if matrices.shape[2] != states:
            raise ArgumentError("A", "an array (m, n, n)", f"shape {matrices.shape}", "one square matrix per vertex")
        inputs = None
        if B is not None:
            source = np.asarray(B)
            shape = (count, states, None) if source.ndim == 3 else (states, None)
            inputs = _exact("B", source, shape, f"one matrix ({states}, r), or one per vertex")
            if inputs.ndim == 2:
                inputs = np.repeat(inputs[None], count, axis=0)
        bounds = rates if rates is None or isinstance(rates, RateBounds) else RateBounds.given(rates)
        if bounds is not None and bounds.high.size != count:
            raise ArgumentError("rates", f"{count} bounds, one per weight", f"{bounds.high.size} of them")
        return PolytopicSystem(matrices, inputs, Simplices.of(count, groups, totals), bounds)

    @property
    def count(self) -> int:
        """Number of vertices m."""
        return int(self.exact_state_matrices.shape[0])

    @property
    def states(self) -> int:
        """Number of states n."""
        return int(self.exact_state_matrices.shape[1])

    @property
    def rates_proven(self) -> bool:
        """Whether a verdict that uses the rates may be called proven."""
        return self.rates is not None and self.rates.proven

    def data(self, *, exact: bool = False, bound: str = "high") -> Data:
        """Arrays for a theorem's formulas: A, B, totals, phi (m,), the latter at one end of its enclosure."""
        number = exact_array if exact else np.asarray
        out: dict[str, Any] = {"A": self.exact_state_matrices if exact else self.A}
        if self.B is not None:
            out["B"] = self.exact_input_matrices if exact else self.B
        totals = exact_array(self.simplices.totals)
        out["totals"] = totals if exact else to_float(totals)
        if self.rates is not None:
            out["phi"] = number(getattr(self.rates, bound))
        return out

    def require_rates(self, theorem: str) -> RateBounds:
        """The bounds on the rates, or RateError that says who needs them."""
        if self.rates is None:
            raise RateError(
                f"{theorem} needs bounds phi_r on the rates of the weights: give rates=, or derive them with "
                "robust_core.symbolic (over the whole box, never its corners)"
            )
        return self.rates

    def attained(self) -> "PolytopicSystem":
        """The same system on the vertices that are attained (products of simplices), as one simplex without rates."""
        mixing = self.simplices.mixing()
        matrices = _mix(mixing, self.exact_state_matrices)
        inputs = None if self.exact_input_matrices is None else _mix(mixing, self.exact_input_matrices)
        return PolytopicSystem(matrices, inputs, Simplices.of(len(mixing)), None)

    def closed_loop(self, K: Any) -> "PolytopicSystem":
        """Vertices A_r + B_r K_r under vertex gains K (m, r, n); only for B_r that are all equal.

        Raises
        ------
        ArgumentError: without B, for another shape of K, or where the B_r differ: the closed loop has products
            sigma_i sigma_j B_i K_j then, which no vertex stands for.
        """
        if self.exact_input_matrices is None:
            raise ArgumentError("model", "a system with inputs", "one without B")
        if not all((self.exact_input_matrices[0] == matrix).all() for matrix in self.exact_input_matrices):
            raise ArgumentError("B", "the same at every vertex", "different ones", "use a theorem on pairs i <= j")
        shape = (self.count, self.exact_input_matrices.shape[2], self.states)
        gains = _exact("K", K, shape, "one gain per vertex")
        return replace(
            self,
            exact_state_matrices=self.exact_state_matrices + self.exact_input_matrices @ gains,
            exact_input_matrices=None,
        )

    def to_json(self) -> dict[str, Any]:
        """Plain data with exact numbers; :meth:`from_json` reads it back."""
        return {
            "kind": "polytopic",
            "A": {"shape": list(self.exact_state_matrices.shape), "values": to_text(self.exact_state_matrices)},
            "B": None
            if self.exact_input_matrices is None
            else {"shape": list(self.exact_input_matrices.shape), "values": to_text(self.exact_input_matrices)},
            "simplices": self.simplices.to_json(),
            "rates": None if self.rates is None else self.rates.to_json(),
        }

    @staticmethod
    def from_json(data: Any) -> "PolytopicSystem":
        """A model from what :meth:`to_json` gave."""
        A, B, simplices, rates = data["A"], data["B"], data["simplices"], data["rates"]
        return PolytopicSystem.of(
            exact_array(A["values"]).reshape(A["shape"]),
            None if B is None else exact_array(B["values"]).reshape(B["shape"]),
            groups=simplices["groups"],
            totals=simplices["totals"],
            rates=None if rates is None else RateBounds.from_json(rates),
        )

    @property
    def digest(self) -> str:
        """SHA-256 of everything the model says; equal models have equal digests."""
        return digest_of(self.to_json())


def _mix(mixing: Exact, matrices: Exact) -> Exact:
    count = matrices.shape[0]
    mixed: Exact = (mixing @ matrices.reshape(count, -1)).reshape(len(mixing), *matrices.shape[1:])
    return mixed
