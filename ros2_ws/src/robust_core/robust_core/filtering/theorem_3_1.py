"""Theorem 3.1: a given filter meets an extended dissipative index, and the error's poles lie in a region."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.errors import ArgumentError
from robust_core.filtering.filter import Filter, error_matrices
from robust_core.filtering.index import DissipativeIndex
from robust_core.lmi import Constraint, Unknown, Unknowns, he
from robust_core.lmi.constraint import blocks, transpose
from robust_core.lmi.unknowns import Values
from robust_core.rational import exact_array, rational, to_float
from robust_core.theorems.base import Data, Theorem, exact_option
from robust_core.theorems.d_stability import kronecker
from robust_core.theorems.options import matrix_option, option_array
from robust_core.theorems.regions import Region


@dataclass(frozen=True)
class DissipativeFilter(Theorem):
    """P > 0 with (3.2.1)-(3.2.4) for one filter, index and level, common to all vertices.

    It holds for weights that vary in any way; the region is one of frozen poles. The unknown G is eliminated. The
    inequalities are scaled by an unknown s > 0, so that they are homogeneous in (P, s).
    """

    NAME = "3.1"
    PROVES = "asymptotic stability of the filtering error, its index and the region of its frozen poles"
    filtering: Filter
    index: DissipativeIndex
    level: str
    region: Region | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "level", exact_option("level", self.level))

    @property
    def figure(self) -> float:
        """The certified figure: gamma or tau."""
        return self.index.figure_at(float(to_float(exact_array(self.level))))

    def specialised(self, model: Any) -> "DissipativeFilter":
        """Itself; raises where the filter or the index does not fit the plant (Assumption 1)."""
        self.filtering.check(model)
        self.index.check(model, self.level)
        return self

    def data(self, model: Any, *, exact: bool = False, bound: str = "high") -> Data:
        """The error system and the index."""
        data = dict(super().data(model, exact=exact, bound=bound))
        data["error"] = error_matrices(data, self.filtering, exact=exact)
        phi, psi1, psi2, psi3 = self.index.matrices()
        weights = (phi, psi1, psi2, psi3 + exact_array(np.eye(len(psi3))) * rational(self.level))
        data["index"] = weights if exact else tuple(to_float(matrix) for matrix in weights)
        if self.region is not None:
            L, M = self.region.matrices
            data["L"], data["M"] = (L, M) if exact else (to_float(L), to_float(M))
        return data

    def unknowns(self, model: Any) -> Unknowns:
        """P (n + k, n + k) and s."""
        return Unknowns((Unknown("P", model.sizes["x"] + self.filtering.order, symmetric=True), Unknown("s", 1)))

    def constraints(self, data: Data, values: Values) -> Sequence[Constraint]:
        """P > 0, s > 0, the dissipation, the peak where there is one, and the poles."""
        P, s = values["P"][..., None, :, :], values["s"][..., None, :, :]
        A, B, C, D = data["error"]
        phi, psi1, psi2, psi3 = data["index"]
        flow, half_drive = P @ A, P @ B
        supplied = transpose(C) @ (psi1 @ D + psi2)
        through = transpose(D) @ psi1 @ D + he(transpose(D) @ psi2) + psi3
        corner = he(flow) - s * (transpose(C) @ psi1 @ C)
        edge = half_drive - s * supplied
        block = blocks([[corner, edge], [transpose(edge), -(s * through)]])
        found = [
            Constraint("P > 0", P, sized=True),
            Constraint("s > 0", s),
            Constraint("dissipation (3.2.2)", -block),
        ]
        if (phi != 0).any():
            found.append(Constraint("peak (3.2.1), (3.2.3)", P - s * (transpose(C) @ phi @ C)))
        if self.region is not None:
            inside = kronecker(data["L"], P) + kronecker(data["M"], flow)
            found.append(Constraint("poles (3.2.4)", -inside - kronecker(transpose(data["M"]), transpose(flow))))
        return found

    def to_json(self) -> dict[str, Any]:
        """Name and options as plain data."""
        options = {
            "filtering": plain_filter(self.filtering),
            "index": self.index.to_json(),
            "level": self.level,
            "region": plain_region(self.region),
        }
        return {"name": self.NAME, "options": options}

    @classmethod
    def options_from_json(cls, options: Mapping[str, Any]) -> dict[str, Any]:
        """Keyword arguments from plain options."""
        f, r = options["filtering"], options["region"]
        return {
            "filtering": Filter.of(f["A"], f["B"], f["C"]),
            "index": DissipativeIndex.from_json(options["index"]),
            "level": options["level"],
            "region": None if r is None else region_from_json(r),
        }


def plain_filter(filtering: Filter) -> dict[str, Any]:
    """A filter as nested lists of texts."""
    return {name: _lists(getattr(filtering, name)) for name in "ABC"}


def plain_region(region: Region | None) -> dict[str, Any] | None:
    """A region as name and nested lists of texts."""
    return None if region is None else {"name": region.name, "L": _lists(region.L), "M": _lists(region.M)}


def region_from_json(content: Any) -> Region:
    """A region from name, L and M as nested lists of texts."""
    L, M = (matrix_option(name, content[name], (None, None)) for name in ("L", "M"))
    if np.shape(option_array(L, exact=False)) != np.shape(option_array(M, exact=False)):
        raise ArgumentError("region", "L and M of one size", f"{L!r} and {M!r}")
    return Region(str(content["name"]), L, M)


def _lists(value: Any) -> Any:
    return [_lists(item) for item in value] if isinstance(value, tuple) else value
