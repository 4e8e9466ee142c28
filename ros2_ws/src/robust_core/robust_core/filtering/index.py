"""The extended dissipative index of Definition 3.1: one inequality for several ways to measure a filter.

int_0^T (z'Psi1 z + 2 z'Psi2 w + w'Psi3 w) dt - z(t)'Phi z(t) >= rho for the error z and the disturbance w. Here
Psi3 = psi3 + level I, and a smaller level is a better filter.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.checks import finite_number
from robust_core.errors import ArgumentError
from robust_core.models.filter_plant import FilterPlant
from robust_core.rational import definite, exact_array, rational, to_float, to_text
from robust_core.theorems.options import MatrixOption, matrix_option, option_array

KEYS = ("phi", "psi1", "psi2", "psi3")


class ImpossibleIndexError(ArgumentError):
    """No filter can meet the index on this plant; the text says why."""


@dataclass(frozen=True, slots=True)
class DissipativeIndex:
    """Phi (z, z), Psi1 (z, z), Psi2 (z, w), psi3 (w, w) in exact numbers, with the name of the figure it reports.

    ``squared``: the level is the square of the figure (gamma); ``negated``: the figure is minus the level (tau);
    ``positive``: a figure of 0 or less would not be the index that was asked for.
    """

    name: str
    phi: MatrixOption
    psi1: MatrixOption
    psi2: MatrixOption
    psi3: MatrixOption
    figure: str = "gamma"
    squared: bool = False
    negated: bool = False
    positive: bool = False

    def matrices(self, *, exact: bool = True) -> tuple[Any, Any, Any, Any]:
        """Phi, Psi1, Psi2 and psi3 in one kind of numbers."""
        phi, psi1, psi2, psi3 = (option_array(m, exact=exact) for m in (self.phi, self.psi1, self.psi2, self.psi3))
        return phi, psi1, psi2, psi3

    def figure_at(self, level: float) -> float:
        """The figure that a level stands for; levels below 0 by rounding count as 0 where it is a square root."""
        if self.squared:
            return float(np.sqrt(max(level, 0.0)))
        return 0.0 - level if self.negated else level

    def check(self, plant: FilterPlant, level: Any = None) -> None:
        """Assumption 1 of chapter 3 for this plant; with a level, its last point too.

        Raises
        ------
        ImpossibleIndexError: naming the point that fails and what to try.
        """
        sizes = plant.sizes
        phi, psi1, psi2, psi3 = self.matrices()
        for label, matrix, shape in (
            ("Phi", phi, "zz"),
            ("Psi1", psi1, "zz"),
            ("Psi2", psi2, "zw"),
            ("Psi3", psi3, "ww"),
        ):
            wanted = tuple(sizes[letter] for letter in shape)
            if matrix.shape != wanted:
                raise ImpossibleIndexError(
                    label, f"of shape {wanted}", f"shape {matrix.shape}", "passivity compares signals of equal length"
                )
        for label, matrix in (("Phi", phi), ("Psi1", -psi1)):
            if not (matrix == matrix.T).all() or not definite(matrix, strict=False):
                raise ImpossibleIndexError(label, "symmetric with Phi >= 0 and Psi1 <= 0", str(to_text(matrix)))
        feedthrough = plant.exact["D"]
        if (phi != 0).any() and ((feedthrough != 0).any() or (psi1 != 0).any() or (psi2 != 0).any()):
            raise ImpossibleIndexError(
                "Phi",
                "zero unless D, Psi1 and Psi2 are",
                "a peak bound with feedthrough or other terms",
                "an energy-to-peak bound needs D = 0; use the H-infinity index",
            )
        if level is None and not self.positive:
            return
        level = 0 if level is None else level
        whole = psi3 + exact_array(np.eye(sizes["w"])) * rational(level)
        for vertex, D in enumerate(feedthrough):
            form = D.T @ psi1 @ D + D.T @ psi2 + psi2.T @ D + whole
            if not definite(form):
                raise ImpossibleIndexError(
                    self.figure,
                    "such that D'Psi1 D + D'Psi2 + Psi2'D + Psi3 > 0 (Assumption 1.5)",
                    f"{self.figure_at(float(to_float(exact_array(level)))):g}, which breaks it at vertex {vertex}",
                    "with D = 0 very strict passivity with tau > 0 has no filter (erratum 3.3-tau)",
                )

    def to_json(self) -> dict[str, Any]:
        """Plain data with exact numbers; :meth:`from_json` reads it back."""
        return {
            "name": self.name,
            "figure": self.figure,
            "squared": self.squared,
            "negated": self.negated,
            "positive": self.positive,
            **{key: plain_matrix(getattr(self, key)) for key in KEYS},
        }

    @staticmethod
    def from_json(data: Any) -> "DissipativeIndex":
        """An index from what :meth:`to_json` gave."""
        matrices = {key: matrix_option(key, data[key], (None, None)) for key in KEYS}
        return DissipativeIndex(
            str(data["name"]),
            **matrices,
            figure=str(data["figure"]),
            squared=bool(data["squared"]),
            negated=bool(data["negated"]),
            positive=bool(data["positive"]),
        )


def plain_matrix(option: MatrixOption) -> Any:
    """Nested lists of texts."""
    return [list(row) for row in option]


def _scaled_identity(size: int, factor: Any = 1) -> MatrixOption:
    return matrix_option("weight", exact_array(np.eye(size)) * rational(factor), (size, size))


def _zero(rows: int, columns: int) -> MatrixOption:
    return matrix_option("weight", np.zeros((rows, columns)), (rows, columns))


def h_infinity(z: int = 1, w: int = 1) -> DissipativeIndex:
    """Energy of the error at most gamma^2 times that of the disturbance.

    >>> h_infinity().figure_at(0.04)
    0.2
    """
    zero = _zero(z, w)
    return DissipativeIndex(
        "h_infinity", _scaled_identity(z, 0), _scaled_identity(z, -1), zero, _scaled_identity(w, 0), squared=True
    )


def energy_to_peak(z: int = 1, w: int = 1) -> DissipativeIndex:
    """Peak of the error at most gamma times the root of the disturbance's energy (L2 to L-infinity)."""
    zero = _zero(z, w)
    return DissipativeIndex(
        "energy_to_peak", _scaled_identity(z), _scaled_identity(z, 0), zero, _scaled_identity(w, 0), squared=True
    )


def passive(size: int = 1) -> DissipativeIndex:
    """Passivity up to gamma: int 2 z'w + gamma w'w >= 0. Psi3 = gamma, not its square (erratum 3.3-passive)."""
    zero = _scaled_identity(size, 0)
    return DissipativeIndex("passive", zero, zero, _scaled_identity(size), zero)


def dissipative(Q: Any, S: Any, R: Any) -> DissipativeIndex:
    """Strict (Q, S, R)-dissipativity: Psi1 = Q <= 0 (z, z), Psi2 = S (z, w), Psi3 = R - tau I; larger tau is better."""
    q, s, r = (matrix_option(name, np.atleast_2d(m), (None, None)) for name, m in (("Q", Q), ("S", S), ("R", R)))
    return DissipativeIndex("dissipative", _zero(len(q), len(q)), q, s, r, figure="tau", negated=True)


def very_strictly_passive(epsilon: Any, size: int = 1) -> DissipativeIndex:
    """Very strict passivity: int 2 z'w - epsilon z'z - tau w'w >= rho. With D = 0 no tau > 0 is possible."""
    finite_number("epsilon", float(to_float(exact_array(epsilon))), low=0.0, open_low=True)
    zero = _scaled_identity(size, 0)
    return DissipativeIndex(
        "very_strictly_passive",
        zero,
        _scaled_identity(size, -rational(epsilon)),
        _scaled_identity(size),
        zero,
        figure="tau",
        negated=True,
        positive=True,
    )
