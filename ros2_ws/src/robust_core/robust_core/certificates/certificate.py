"""The certificate object."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from robust_core.certificates import dual, primal
from robust_core.errors import ArgumentError
from robust_core.rational import Exact, Floats
from robust_core.theorems.base import Model, Theorem

Mode = Literal["exact", "float"]
Margins = Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Certificate:
    """A theorem, a model, and either a solution of the inequalities (``values``) or what rules one out.

    ``values`` holds the unknown matrices as floats, which stand for their exact binary values; ``multipliers`` exact
    numbers; one of the two is None. ``margins`` are those found when it was made, for the reader.
    """

    theorem: Theorem
    model: Model
    values: Mapping[str, Floats] | None
    multipliers: Mapping[str, Exact] | None = None
    margins: Margins = field(default_factory=dict)

    def __post_init__(self) -> None:
        if (self.values is None) == (self.multipliers is None):
            raise ArgumentError("values", "given, or multipliers, not both", "both or none")

    @property
    def feasible(self) -> bool:
        """Whether it claims a solution, rather than that there is none."""
        return self.values is not None

    @property
    def claim(self) -> str:
        """What it proves, in words."""
        if self.feasible:
            return f"theorem {self.theorem.NAME}: {self.theorem.PROVES}"
        return f"theorem {self.theorem.NAME} has no solution for this model"

    def verify(self, mode: Mode = "exact") -> Margins:
        """Repeat the proof without a solver and return the margins in floating point.

        In mode "exact" every inequality is decided in rational arithmetic. Mode "float" looks at eigenvalues and is for
        solutions only: an equation between floats proves nothing.

        Raises
        ------
        ProofFailedError: if it does not hold; the text names the inequality.
        """
        if self.values is not None:
            if mode == "exact":
                primal.check_exact(self.theorem, self.model, self.values)
                return primal.float_margins(self.theorem, self.model, self.values)
            return primal.check_float(self.theorem, self.model, self.values)
        if mode != "exact":
            raise ArgumentError("mode", '"exact" for a certificate of infeasibility', repr(mode))
        dual.check_dual(self.theorem, self.model, self.multipliers or {})
        return {}

    def vertex_matrices(self) -> Any:
        """P at the vertices (m, n, n), of a stability theorem's solution."""
        fill = getattr(self.theorem, "vertex_matrices", None)
        if fill is None or self.values is None:
            raise ArgumentError("certificate", "a solution of a stability theorem", self.claim)
        return fill(self.model, self.values)
