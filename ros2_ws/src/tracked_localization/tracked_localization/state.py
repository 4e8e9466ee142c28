"""Layout of the filter's state vector, and what its covariance may look like."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

X, Y, YAW, SPEED, YAW_RATE, BIAS, ROLLED, ACCELERATION, YAW_ACCELERATION, SHARE, SLIDE = range(11)
SIZE = 11

_FLOOR = 1e-12
_CEILING = np.array([1e4, 1e4, 1e2, 1.0, 10.0, 1e-2, 1e2, 1e2, 1e3, 1.0, 1.0])


def row(*ones: int) -> Array:
    """Measurement row (1, 11) that sums these components."""
    selection = np.zeros((1, SIZE))
    selection[0, list(ones)] = 1.0
    return selection


def keep_positive_definite(covariance: Array) -> None:
    """Make a covariance (11, 11) exactly symmetric and safely positive definite, in place."""
    covariance += covariance.T
    covariance *= 0.5
    lift(covariance)


def lift(covariance: Array) -> None:
    """Make a symmetric covariance (11, 11) safely positive definite, in place."""
    covariance.ravel()[:: SIZE + 1] += _FLOOR  # a view: covariances are contiguous


def bound(covariance: Array) -> None:
    """Keep the variances of a covariance (11, 11) below what could ever matter, in place."""
    diagonal = covariance.diagonal()
    if (diagonal > _CEILING).any():
        # Scaling rows and columns alike keeps a matrix positive definite; clipping its diagonal does not.
        scale = np.sqrt(_CEILING / np.maximum(diagonal, _CEILING))
        covariance *= scale[:, None] * scale


def forget(covariance: Array, component: int, variance: float) -> None:
    """Make one component independent of the others, with a new variance, in place."""
    covariance[component, :] = 0.0
    covariance[:, component] = 0.0
    covariance[component, component] = variance
