"""Hermitian matrices by real numbers, for floats and exact numbers alike."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.lmi.constraint import blocks, transpose


@dataclass(frozen=True, slots=True)
class ComplexForm:
    """``real`` + i ``imaginary``, stacks of matrices."""

    real: Any
    imaginary: Any

    def __add__(self, other: "ComplexForm") -> "ComplexForm":
        return ComplexForm(self.real + other.real, self.imaginary + other.imaginary)

    def __neg__(self) -> "ComplexForm":
        return ComplexForm(-self.real, -self.imaginary)

    def turned(self, factor: Any) -> "ComplexForm":
        """Times i ``factor``, a real number."""
        return ComplexForm(-factor * self.imaginary, factor * self.real)

    def scaled(self, factor: Any) -> "ComplexForm":
        """Times a real number."""
        return ComplexForm(factor * self.real, factor * self.imaginary)

    @property
    def adjoint(self) -> "ComplexForm":
        """The conjugate transpose."""
        return ComplexForm(transpose(self.real), -transpose(self.imaginary))

    def embedded(self) -> Any:
        """[Re, -Im; Im, Re]: real symmetric and of the same definiteness where this is Hermitian."""
        return blocks([[self.real, -self.imaginary], [self.imaginary, self.real]])


def hermitian(free: Any) -> ComplexForm:
    """The Hermitian matrix whose n^2 real numbers a full matrix (..., n, n) holds.

    The upper triangle is the real part's, the strict lower one the imaginary part's.
    """
    size = free.shape[-1]
    upper, strict = np.triu(np.ones((size, size), dtype=int)), np.tril(np.ones((size, size), dtype=int), -1)
    top, low = free * upper, free * strict
    return ComplexForm(top + transpose(free * np.triu(np.ones((size, size), dtype=int), 1)), low - transpose(low))


def complex_blocks(rows: list[list[ComplexForm | None]]) -> ComplexForm:
    """A block matrix; None stands for zero."""
    real = [[None if block is None else block.real for block in row] for row in rows]
    imaginary = [[None if block is None else block.imaginary for block in row] for row in rows]
    return ComplexForm(blocks(real), blocks(imaginary))


def real_form(matrix: Any) -> ComplexForm:
    """A real matrix."""
    return ComplexForm(matrix, 0 * matrix)
