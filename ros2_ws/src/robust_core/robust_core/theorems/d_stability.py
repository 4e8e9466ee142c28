"""D-stability: the eigenvalues of every frozen A(sigma) lie in a region of the complex plane."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from robust_core.errors import ArgumentError
from robust_core.lmi import Constraint, Unknown, Unknowns
from robust_core.lmi.constraint import transpose
from robust_core.lmi.unknowns import Values
from robust_core.rational import to_float
from robust_core.theorems.base import Data, Theorem
from robust_core.theorems.regions import Matrix, Region


@dataclass(frozen=True)
class DStability(Theorem):
    """P > 0 with L x P + M x (P A_i) + M^T x (P A_i)^T < 0 (Kronecker products) for all i, one P for all vertices.

    Sufficient for every frozen sigma; a varying sigma has no eigenvalues to speak of.
    """

    NAME = "D-stability"
    PROVES = "eigenvalues of every frozen system in the region"
    region: str = ""
    L: Matrix = ()
    M: Matrix = ()

    @staticmethod
    def within(region: Region) -> "DStability":
        """The theorem for a region."""
        return DStability(region.name, region.L, region.M)

    def __post_init__(self) -> None:
        size = len(self.L)
        if size == 0 or any(len(row) != size for row in (*self.L, *self.M)) or len(self.M) != size:
            raise ArgumentError(
                "region", "square matrices L and M of one size", f"{self.L!r} and {self.M!r}", "use within()"
            )

    def data(self, model: Any, *, exact: bool = False, bound: str = "high") -> Data:
        """With the region's matrices."""
        L, M = Region(self.region, self.L, self.M).matrices
        more = {"L": L, "M": M} if exact else {"L": to_float(L), "M": to_float(M)}
        return {**super().data(model, exact=exact, bound=bound), **more}

    def unknowns(self, model: Any) -> Unknowns:
        """P (n, n)."""
        return Unknowns((Unknown("P", model.states, symmetric=True),))

    def constraints(self, data: Data, values: Values) -> Sequence[Constraint]:
        """P > 0 and the region's inequality at the vertices."""
        P = values["P"][..., None, :, :]
        product = P @ data["A"]
        inside = kronecker(data["L"], P) + kronecker(data["M"], product)
        inside = inside + kronecker(transpose(data["M"]), transpose(product))
        return (Constraint("P > 0", P, sized=True), Constraint("region < 0", -inside))


def kronecker(small: Any, stack: Any) -> Any:
    """Kronecker product of one matrix (k, k) with a stack (..., n, n)."""
    k, n = small.shape[-1], stack.shape[-1]
    product = small[:, None, :, None] * stack[..., None, :, None, :]
    return product.reshape(*stack.shape[:-2], k * n, k * n)
