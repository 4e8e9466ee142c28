"""Systems whose signal z is to be estimated from a measurement y under a disturbance w, (3.1.4)."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from robust_core.checks import finite_array
from robust_core.errors import ArgumentError
from robust_core.models.polytope import Data, digest_of
from robust_core.models.simplices import Simplices
from robust_core.rational import Exact, Floats, exact_array, to_float, to_text

NAMES = ("A", "B", "C", "D", "E", "F")


@dataclass(frozen=True, slots=True)
class FilterPlant:
    """x' = A_i x + B_i w, z = C_i x + D_i w, y = E_i x + F_i w, mixed by weights. Build it with :meth:`of`.

    ``exact`` holds the six stacks (m, rows, columns) of exact numbers by name.
    """

    exact: dict[str, Exact]
    simplices: Simplices
    floats: dict[str, Floats] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "floats", {name: to_float(stack) for name, stack in self.exact.items()})

    @staticmethod
    def of(
        *,
        A: Any,
        B: Any,
        C: Any,
        D: Any = None,
        E: Any,
        F: Any = None,
        groups: Sequence[Sequence[int]] | None = None,
        totals: Sequence[Any] | None = None,
    ) -> "FilterPlant":
        """A checked plant: A (m, n, n); the others one matrix per vertex or one for all; D and F default to zero.

        Numbers may be floats, or integers, Fractions and texts for exact ones.

        >>> plant = FilterPlant.of(A=[[[-1]], [[-2]]], B=[[1]], C=[["1/3"]], E=[[1]], F=[[-1]])
        >>> plant.count, plant.sizes
        (2, {'x': 1, 'w': 1, 'z': 1, 'y': 1})

        Raises
        ------
        ArgumentError: naming the matrix, its expected shape and what to try.
        """
        states = _stack("A", A, None, None, None)
        count, n = states.shape[:2]
        if states.shape[2] != n:
            raise ArgumentError("A", "an array (m, n, n)", f"shape {states.shape}", "one square matrix per vertex")
        exact = {"A": states, "B": _stack("B", B, count, n, None)}
        w = exact["B"].shape[2]
        exact["C"] = _stack("C", C, count, None, n)
        exact["E"] = _stack("E", E, count, None, n)
        for name, value, output in (("D", D, "C"), ("F", F, "E")):
            rows = exact[output].shape[1]
            exact[name] = _stack(name, np.zeros((rows, w)) if value is None else value, count, rows, w)
        return FilterPlant({name: exact[name] for name in NAMES}, Simplices.of(count, groups, totals))

    @property
    def count(self) -> int:
        """Number of vertices m."""
        return int(self.exact["A"].shape[0])

    @property
    def sizes(self) -> dict[str, int]:
        """Lengths of x, w, z and y."""
        return {
            "x": int(self.exact["A"].shape[1]),
            "w": int(self.exact["B"].shape[2]),
            "z": int(self.exact["C"].shape[1]),
            "y": int(self.exact["E"].shape[1]),
        }

    @property
    def rates_proven(self) -> bool:
        """True: nothing in chapter 3 depends on the rates of the weights."""
        return True

    def data(self, *, exact: bool = False, bound: str = "high") -> Data:
        """The six stacks by name; ``bound`` is of no meaning here."""
        return dict(self.exact if exact else self.floats)

    def attained(self) -> "FilterPlant":
        """The same plant on the vertices that are attained (products of simplices), as one simplex."""
        mixing = self.simplices.mixing()
        mixed = {
            name: (mixing @ stack.reshape(self.count, -1)).reshape(len(mixing), *stack.shape[1:])
            for name, stack in self.exact.items()
        }
        return FilterPlant(mixed, Simplices.of(len(mixing)))

    def to_json(self) -> dict[str, Any]:
        """Plain data with exact numbers; :meth:`from_json` reads it back."""
        stacks = {name: {"shape": list(stack.shape), "values": to_text(stack)} for name, stack in self.exact.items()}
        return {"kind": "filter_plant", "matrices": stacks, "simplices": self.simplices.to_json()}

    @staticmethod
    def from_json(data: Any) -> "FilterPlant":
        """A plant from what :meth:`to_json` gave."""
        stacks = {
            name: exact_array(data["matrices"][name]["values"]).reshape(data["matrices"][name]["shape"])
            for name in NAMES
        }
        return FilterPlant.of(**stacks, groups=data["simplices"]["groups"], totals=data["simplices"]["totals"])

    @property
    def digest(self) -> str:
        """SHA-256 of everything the plant says."""
        return digest_of(self.to_json())


def _stack(name: str, value: Any, count: int | None, rows: int | None, columns: int | None) -> Exact:
    source = np.asarray(value)
    one_for_all = source.ndim == 2 and count is not None
    shape = (rows, columns) if one_for_all else (count, rows, columns)
    exact = exact_array(finite_array(name, source, shape) if source.dtype.kind in "fiub" else source)
    finite_array(name, to_float(exact), shape, "one matrix per vertex, or one for all")
    return np.repeat(exact[None], count, axis=0) if one_for_all and count is not None else exact
