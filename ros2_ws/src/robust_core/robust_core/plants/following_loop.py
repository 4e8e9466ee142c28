"""The person-following loop of (6.2.5)-(6.2.9): distance error and bearing under the feedback law.

eps' = -gamma cos(alpha)^2 eps, alpha' = -k alpha. The thesis writes it between diag(-gamma, -k) and diag(0, -k) and
claims global exponential convergence; the second is not negative definite, and no common P proves a decay (erratum
6.2.9). While the person is in the field of view, |alpha| <= alpha_max < pi/2, cos^2 is at least cos(alpha_max)^2.
"""

import math

import numpy as np

from robust_core.checks import finite_number
from robust_core.errors import ArgumentError
from robust_core.models import PolytopicSystem
from robust_core.rational import rational


def following_loop(gamma: float, k: float, field_of_view_rad: float) -> PolytopicSystem:
    """The loop while |alpha| <= ``field_of_view_rad``, for gains gamma and k (1/s): a regional model.

    The decay rate of V = eps^2 + alpha^2 that it certifies is min(gamma cos(alpha_max)^2, k), in the state.

    >>> following_loop(0.8, 2.0, 0.5).count
    2

    Raises
    ------
    ArgumentError: for gains that are not positive or a field of view of pi/2 or more.
    """
    finite_number("gamma", gamma, low=0.0, open_low=True)
    finite_number("k", k, low=0.0, open_low=True)
    angle = finite_number("field_of_view_rad", field_of_view_rad, low=0.0)
    if angle >= math.pi / 2.0:
        raise ArgumentError(
            "field_of_view_rad", "below pi/2", repr(field_of_view_rad), "beyond it the distance error does not decay"
        )
    least = rational(math.cos(angle) ** 2 * (1.0 - 1e-12))
    return _loop(gamma, k, least)


def printed_loop(gamma: float, k: float) -> PolytopicSystem:
    """The printed vertices, with cos^2 between 0 and 1: stable in no direction of the distance error at the second."""
    finite_number("gamma", gamma, low=0.0, open_low=True)
    finite_number("k", k, low=0.0, open_low=True)
    return _loop(gamma, k, rational(0))


def _loop(gamma: float, k: float, least: object) -> PolytopicSystem:
    fast, turn = rational(gamma), rational(k)
    matrices = [[[-fast * share, rational(0)], [rational(0), -turn]] for share in (rational(1), least)]
    return PolytopicSystem.of(np.array(matrices, dtype=object))
