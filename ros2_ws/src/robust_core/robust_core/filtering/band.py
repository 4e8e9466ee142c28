"""Frequency responses of filtering errors: gains on grids, and what no filter can do better."""

from typing import Any

import numpy as np

from robust_core.checks import finite_number
from robust_core.filtering.filter import Filter, error_matrices
from robust_core.models import FilterPlant
from robust_core.rational import Floats

GRID = 201


def error_gain(plant: FilterPlant, filtering: Filter, frequencies: Any) -> Floats:
    """Largest singular value of the error's response at every vertex (m, ...) for frequencies (...) in rad/s."""
    A, B, C, D = error_matrices(plant.data(), filtering, exact=False)
    s = 1j * np.asarray(frequencies, dtype=np.float64)[..., None, None]
    unit = np.eye(A.shape[-1])
    gains = []
    for a, b, c, d in zip(A, B, C, D, strict=True):
        response = c @ np.linalg.solve(s * unit - a, b + 0.0 * s[..., :1]) + d
        gains.append(np.linalg.norm(response, 2, axis=(-2, -1)))
    return np.asarray(gains)


def band_gain(plant: FilterPlant, filtering: Filter, band: tuple[float, float], *, points: int = GRID) -> float:
    """The largest gain of the vertices on a grid of the band."""
    low, high = finite_number("band[0]", band[0]), finite_number("band[1]", band[1])
    return float(error_gain(plant, filtering, np.linspace(low, high, points)).max())


def limit_of_filters(plant: FilterPlant, frequency: float, *, iterations: int = 20_000) -> float:
    """A gain that no linear filter can be below at this frequency, one measured and one estimated signal, one w.

    The vertices' responses are z_i and y_i; a filter is one complex number F there, and max_i |z_i - F y_i| is least
    for some F: by weights a_i on the vertices the root of the least of sum a_i |z_i - F y_i|^2 bounds it from below,
    and the best weights (multiplicative updates) make the bound tight. Sound for every number of iterations.
    """
    d = plant.data()
    s = 1j * finite_number("frequency", frequency)
    z, y = [], []
    for a, b, c, through, e, f in zip(*(d[name] for name in "ABCDEF"), strict=True):
        x = np.linalg.solve(s * np.eye(len(a)) - a, b + 0j)
        z.append((c @ x + through)[0, 0])
        y.append((e @ x + f)[0, 0])
    signal, measured = np.array(z), np.array(y)
    weights, best = np.full(len(z), 1.0 / len(z)), 0.0
    for _ in range(iterations):
        F = (weights * signal * measured.conj()).sum() / max((weights * np.abs(measured) ** 2).sum(), 1e-300)
        errors = np.abs(signal - F * measured)
        bound = float(np.sqrt((weights * errors**2).sum()))
        best = max(best, bound)
        if errors.max() - bound <= 1e-9 * errors.max():
            break
        weights = weights * errors
        weights /= weights.sum()
    return best
