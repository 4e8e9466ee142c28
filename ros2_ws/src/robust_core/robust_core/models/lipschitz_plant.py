"""Discrete plants with one Lipschitz term: x+ = A x + D_f f(x) + B u + D d, y = C x, (4.3.1)."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from robust_core.errors import ArgumentError
from robust_core.models.polytope import Data, digest_of
from robust_core.rational import Exact, Floats, exact_array, to_float, to_text
from robust_core.theorems.options import matrix_option, option_array

NAMES = ("A", "B", "C", "Df", "D")


@dataclass(frozen=True, slots=True)
class LipschitzPlant:
    """Exact matrices by name: A (n, n), B (n, u), C (y, n), Df (n, f), D (n, d). Build it with :meth:`of`."""

    exact: dict[str, Exact]
    floats: dict[str, Floats] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "floats", {name: to_float(matrix) for name, matrix in self.exact.items()})

    @staticmethod
    def of(*, A: Any, B: Any, C: Any, Df: Any, D: Any) -> "LipschitzPlant":
        """A checked plant; numbers may be floats, or integers, Fractions and texts for exact ones.

        Raises
        ------
        ArgumentError: naming the matrix and its expected shape.
        """
        size = len(np.asarray(A))
        shapes = {"A": (size, size), "B": (size, None), "C": (None, size), "Df": (size, None), "D": (size, None)}
        given = {"A": A, "B": B, "C": C, "Df": Df, "D": D}
        exact = {
            name: exact_array(option_array(matrix_option(name, given[name], shape), exact=True))
            for name, shape in shapes.items()
        }
        return LipschitzPlant(exact)

    @property
    def states(self) -> int:
        """Number of states n."""
        return int(self.exact["A"].shape[0])

    @property
    def rates_proven(self) -> bool:
        """True: no rates are involved."""
        return True

    def data(self, *, exact: bool = False, bound: str = "high") -> Data:
        """The matrices by name; ``bound`` is of no meaning here."""
        return dict(self.exact if exact else self.floats)

    def to_json(self) -> dict[str, Any]:
        """Plain data with exact numbers; :meth:`from_json` reads it back."""
        matrices = {name: {"shape": list(m.shape), "values": to_text(m)} for name, m in self.exact.items()}
        return {"kind": "lipschitz_plant", "matrices": matrices}

    @staticmethod
    def from_json(data: Any) -> "LipschitzPlant":
        """A plant from what :meth:`to_json` gave."""
        matrices = data["matrices"]
        if set(matrices) != set(NAMES):
            raise ArgumentError("matrices", f"named {', '.join(NAMES)}", ", ".join(sorted(matrices)))
        return LipschitzPlant.of(
            **{name: exact_array(matrices[name]["values"]).reshape(matrices[name]["shape"]) for name in NAMES}
        )

    @property
    def digest(self) -> str:
        """SHA-256 of everything the plant says."""
        return digest_of(self.to_json())
