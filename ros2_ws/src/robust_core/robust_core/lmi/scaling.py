"""Equilibration of badly scaled LMIs by powers of two, so that nothing is rounded.

Each block is congruent to D F D for a positive diagonal D, and each unknown may be measured in its own unit; both leave
feasibility and the sign of multipliers alone. A model in badly chosen units thus gets back to good ones.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from robust_core.lmi.coefficients import Family
from robust_core.rational import Floats

SPREAD = 2.0**10
"""Ratio of the largest coefficients of rows and unknowns beyond which they are equilibrated."""

SPREAD_OF_ALL = 2.0**24
"""The same for all coefficients that are not zero."""


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


def _fit(families: Sequence[Family]) -> tuple[list[Floats], Floats]:
    """Least squares of the logarithms of all non-zeros: log2 |F_i[a, b]| + d_a + d_b + u_i near 0."""
    size = len(families[0].linear)
    starts = np.cumsum([size, *(int(np.prod(family.constant.shape[:2])) for family in families)])
    normal, right = np.zeros((starts[-1], starts[-1])), np.zeros(starts[-1])
    for family, start in zip(families, starts[:-1], strict=True):
        unknown, block, row, column = np.nonzero(family.linear)
        target = -np.log2(np.abs(family.linear[unknown, block, row, column]))
        n = family.constant.shape[1]
        terms = (unknown, start + block * n + row, start + block * n + column)
        for one in terms:
            np.add.at(right, one, target)
            for other in terms:
                np.add.at(normal, (one, other), 1.0)
    # Scales that no non-zero fixes stay at 1.
    found = np.linalg.solve(normal + 1e-6 * np.eye(len(right)), right)
    scales = _power_of_two(np.exp2(np.clip(found, -400.0, 400.0)))
    congruences = [
        scales[start:stop].reshape(family.constant.shape[:2])
        for family, start, stop in zip(families, starts[:-1], starts[1:], strict=True)
    ]
    return congruences, scales[:size]


def _power_of_two(values: Floats) -> Floats:
    return np.asarray(np.exp2(np.round(np.log2(values))), dtype=np.float64)


def equilibrate(families: Sequence[Family]) -> tuple[tuple[Family, ...], Scaling | None]:
    """Families with entries near 1, and how to undo it; None where they were well scaled already."""
    magnitudes = [np.abs(family.linear) for family in families]
    peaks = np.concatenate(
        [np.max([one.max(axis=(1, 2, 3)) for one in magnitudes], axis=0)]
        + [one.max(axis=(0, 3)).ravel() for one in magnitudes]
    )
    peaks, least = peaks[peaks > 0.0], min(one[one > 0.0].min(initial=np.inf) for one in magnitudes)
    if peaks.size == 0 or (peaks.max() <= SPREAD * peaks.min() and peaks.max() <= SPREAD_OF_ALL * least):
        return tuple(families), None
    congruences, units = _fit(families)
    out = []
    for family, d in zip(families, congruences, strict=True):
        outer = d[:, :, None] * d[:, None, :]
        linear = family.linear * units[:, None, None, None] * outer
        out.append(replace(family, constant=family.constant * outer, linear=linear))
    return tuple(out), Scaling(tuple(congruences), units)
