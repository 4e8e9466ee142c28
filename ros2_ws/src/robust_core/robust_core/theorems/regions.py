"""LMI regions of the complex plane: {s : L + s M + conj(s) M^T < 0}."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.checks import finite_number
from robust_core.errors import ArgumentError
from robust_core.rational import Exact, exact_array, rational, to_float, to_text

Matrix = tuple[tuple[str, ...], ...]


@dataclass(frozen=True, slots=True)
class Region:
    """Exact L (symmetric) and M, as texts so that a region is plain data."""

    name: str
    L: Matrix
    M: Matrix

    @property
    def matrices(self) -> tuple[Exact, Exact]:
        """L and M in exact numbers."""
        return exact_array(self.L), exact_array(self.M)

    def contains(self, points: Any) -> Any:
        """Whether complex numbers lie inside (in floats)."""
        L, M = (to_float(matrix) for matrix in self.matrices)
        s = np.asarray(points)[..., None, None]
        return np.linalg.eigvalsh(L + s * M + np.conj(s) * M.T).max(axis=-1) < 0.0

    def __and__(self, other: "Region") -> "Region":
        """The intersection."""
        (L1, M1), (L2, M2) = self.matrices, other.matrices
        return _region(f"{self.name} and {other.name}", _diagonal(L1, L2), _diagonal(M1, M2))


def _diagonal(first: Exact, second: Exact) -> Exact:
    size, more = len(first), len(second)
    out = np.full((size + more, size + more), rational(0), dtype=object)
    out[:size, :size], out[size:, size:] = first, second
    return out


def _region(name: str, L: Any, M: Any) -> Region:
    texts = []
    for matrix in (exact_array(L), exact_array(M)):
        flat = iter(to_text(matrix))
        texts.append(tuple(tuple(next(flat) for _ in row) for row in matrix))
    return Region(name, texts[0], texts[1])


def disc(center: float, radius: float) -> Region:
    """The open disc U(center, radius) around a real centre.

    >>> disc(-20.0, 19.9).contains([-1.0, 0.0]).tolist()
    [True, False]
    """
    q, r = finite_number("center", center), finite_number("radius", radius, low=0.0, open_low=True)
    return _region(
        f"disc({q:g}, {r:g})", [[-rational(r), -rational(q)], [-rational(q), -rational(r)]], [[0, 1], [0, 0]]
    )


def half_plane(bound: float) -> Region:
    """Re s < bound."""
    value = finite_number("bound", bound)
    return _region(f"Re < {value:g}", [[-2 * rational(value)]], [[1]])


def sector(angle_rad: float) -> Region:
    """|Im s| < tan(angle) |Re s| on the left: damping of at least cos(angle)."""
    angle = finite_number("angle_rad", angle_rad, low=0.0, high=math.pi / 2.0, open_low=True)
    if angle == math.pi / 2.0:
        raise ArgumentError("angle_rad", "below pi/2", repr(angle_rad), "use half_plane(0)")
    sine, cosine = rational(math.sin(angle)), rational(math.cos(angle))
    return _region(f"sector({angle:g})", [[0, 0], [0, 0]], [[sine, cosine], [-cosine, sine]])


def intersection(regions: Sequence[Region]) -> Region:
    """What all regions have in common."""
    if not regions:
        raise ArgumentError("regions", "at least one", "none")
    common = regions[0]
    for region in regions[1:]:
        common = common & region
    return common
