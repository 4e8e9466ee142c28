"""Equilibration of badly scaled LMIs by powers of two, so that nothing is rounded.

Each block is congruent to D F D for a positive diagonal D, and each unknown may be measured in its own unit; both leave
feasibility and the sign of multipliers alone. Geometric means of largest and smallest entries are driven to 1.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from robust_core.lmi.coefficients import Family
from robust_core.rational import Floats

_SPREAD = 2.0**10
_PASSES = 12


@dataclass(frozen=True, slots=True)
class Scaling:
    """``congruences`` holds the diagonals (K, n) of each family, ``units`` (size,) those of the unknowns."""

    congruences: tuple[Floats, ...]
    units: Floats

    def multipliers(self, scaled: Sequence[Floats]) -> tuple[Floats, ...]:
        """Multipliers of the original blocks from those of the scaled ones."""
        return tuple(
            d[:, :, None] * matrices * d[:, None, :] for d, matrices in zip(self.congruences, scaled, strict=True)
        )


def _power_of_two(values: Floats) -> Floats:
    return np.asarray(np.exp2(np.round(np.log2(values))), dtype=np.float64)


def equilibrate(families: Sequence[Family]) -> tuple[tuple[Family, ...], Scaling | None]:
    """Families with entries near 1, and how to undo it; None where they were well scaled already."""
    largest = [np.abs(family.linear).max(axis=(0, 1, 2, 3)) for family in families]
    by_unknown = np.max([np.abs(family.linear).max(axis=(1, 2, 3)) for family in families], axis=0)
    used = by_unknown[by_unknown > 0.0]
    if used.size == 0 or max(max(largest), used.max()) <= _SPREAD * min(min(v for v in largest if v > 0.0), used.min()):
        return tuple(families), None
    congruences = [np.ones(family.constant.shape[:2]) for family in families]
    units = np.ones(by_unknown.size)
    magnitudes = [np.abs(family.linear) for family in families]
    for _ in range(_PASSES):
        peaks = np.zeros(units.size)
        for k, magnitude in enumerate(magnitudes):
            d = congruences[k]
            scaled = magnitude * units[:, None, None, None] * d[:, :, None] * d[:, None, :]
            row = scaled.max(axis=(0, 3))
            congruences[k] = d / np.sqrt(np.sqrt(np.where(row > 0.0, row, 1.0)))
            d = congruences[k]
            scaled = magnitude * units[:, None, None, None] * d[:, :, None] * d[:, None, :]
            peaks = np.maximum(peaks, scaled.max(axis=(1, 2, 3)))
        units = units / np.sqrt(np.where(peaks > 0.0, peaks, 1.0))
    congruences = [_power_of_two(d) for d in congruences]
    units = _power_of_two(units)
    out = []
    for family, d in zip(families, congruences, strict=True):
        outer = d[:, :, None] * d[:, None, :]
        linear = family.linear * units[:, None, None, None] * outer
        out.append(replace(family, constant=family.constant * outer, linear=linear))
    return tuple(out), Scaling(tuple(congruences), units)
