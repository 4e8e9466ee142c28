"""Classical Runge-Kutta with a fixed step, for many runs at once."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def runge_kutta(
    derivative: Callable[[float, Array], Array], state: Array, start: float, stop: float, step: float
) -> Array:
    """States (count + 1, ...) at every step from ``start`` to ``stop``, for states of any shape."""
    count = round((stop - start) / step)
    out = np.empty((count + 1, *state.shape))
    out[0] = state
    for k in range(count):
        t, x = start + k * step, out[k]
        a = derivative(t, x)
        b = derivative(t + 0.5 * step, x + 0.5 * step * a)
        c = derivative(t + 0.5 * step, x + 0.5 * step * b)
        d = derivative(t + step, x + step * c)
        out[k + 1] = x + step / 6.0 * (a + 2.0 * (b + c) + d)
    return out
