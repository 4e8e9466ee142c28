"""Unknown matrices of an LMI, and the one vector that stands for all of them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robust_core.errors import ArgumentError
from robust_core.rational import Exact, Floats, rational

Values = Mapping[str, Any]
"""The unknowns by name, each (..., count, rows, columns) or, without a count, (..., rows, columns)."""


@dataclass(frozen=True, slots=True)
class Unknown:
    """One unknown matrix, or ``count`` of the same shape.

    A symmetric one has its upper triangle as free entries. A scalar is a (1, 1) matrix.
    """

    name: str
    rows: int
    columns: int = 0
    count: int | None = None
    symmetric: bool = False
    index: NDArray[np.intp] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        if self.columns == 0:
            object.__setattr__(self, "columns", self.rows)
        if self.rows < 1 or self.columns < 1 or (self.count is not None and self.count < 1):
            raise ArgumentError(
                self.name, "an unknown of positive size", f"{self.count} x {self.rows} x {self.columns}"
            )
        if self.symmetric and self.rows != self.columns:
            raise ArgumentError(self.name, "square, being symmetric", f"{self.rows} x {self.columns}")
        object.__setattr__(self, "index", self._positions())

    @property
    def entries(self) -> int:
        """Free entries of one matrix."""
        return self.rows * (self.rows + 1) // 2 if self.symmetric else self.rows * self.columns

    @property
    def size(self) -> int:
        """Free entries of all."""
        return self.entries * (1 if self.count is None else self.count)

    def _positions(self) -> NDArray[np.intp]:
        """For every entry of the matrices, the free entry that it shows."""
        if self.symmetric:
            one = np.zeros((self.rows, self.rows), dtype=np.intp)
            upper = np.triu_indices(self.rows)
            one[upper] = np.arange(self.entries)
            one.T[upper] = one[upper]
        else:
            one = np.arange(self.entries, dtype=np.intp).reshape(self.rows, self.columns)
        if self.count is None:
            return one
        return np.arange(self.count)[:, None, None] * self.entries + one


@dataclass(frozen=True, slots=True)
class Unknowns:
    """All unknowns of a theorem, in the order of their entries in the vector y."""

    items: tuple[Unknown, ...]

    def __post_init__(self) -> None:
        names = [item.name for item in self.items]
        if len(set(names)) != len(names) or not names:
            raise ArgumentError("items", "unknowns with different names", repr(names))

    @property
    def size(self) -> int:
        """Length of y."""
        return sum(item.size for item in self.items)

    def unpack(self, vector: Any) -> dict[str, Any]:
        """Matrices by name from y (..., size); leading axes stay in front. Works on floats and on exact numbers."""
        out, start = {}, 0
        for item in self.items:
            out[item.name] = vector[..., start + item.index]
            start += item.size
        return out

    def pack(self, values: Values) -> Any:
        """Vector y from matrices by name; of a symmetric one the upper triangle counts.

        Raises
        ------
        ArgumentError: for a missing unknown or another shape.
        """
        parts = []
        for item in self.items:
            value = np.asarray(values.get(item.name))
            if value.shape != item.index.shape:
                raise ArgumentError(item.name, f"of shape {item.index.shape}", f"shape {value.shape}")
            where = np.zeros(item.size, dtype=np.intp)
            # Written from the last entry to the first: the first place that shows an entry is in the upper triangle.
            where[item.index.ravel()[::-1]] = np.arange(item.index.size - 1, -1, -1)
            parts.append(value.ravel()[where])
        return np.concatenate(parts)

    def probes(self) -> dict[str, Floats]:
        """Zero and the unit vectors, stacked along a first axis of length size + 1."""
        return _probes(self)

    def exact_probes(self) -> dict[str, Exact]:
        """The same in exact numbers."""
        return _exact_probes(self)


def _stack(size: int) -> Floats:
    return np.vstack([np.zeros(size), np.eye(size)])


@lru_cache(maxsize=64)
def _probes(unknowns: Unknowns) -> dict[str, Floats]:
    return unknowns.unpack(_stack(unknowns.size))


@lru_cache(maxsize=64)
def _exact_probes(unknowns: Unknowns) -> dict[str, Exact]:
    numbers = np.where(_stack(unknowns.size) == 1.0, rational(1), rational(0)).astype(object)
    return unknowns.unpack(numbers)
