"""What the stability theorems of chapter 2 share: V(x) = x^T (sum_r sigma_r P_r) x and its decay rate."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robust_core.errors import ArgumentError
from robust_core.lmi import Unknown, Unknowns, he
from robust_core.theorems.base import Data, Theorem, exact_option, option_number


@dataclass(frozen=True)
class LyapunovTheorem(Theorem):
    """Stability with V' < -2 decay V; ``decay`` (1/s) is kept exactly, as text."""

    decay: Any = "0"

    def __post_init__(self) -> None:
        object.__setattr__(self, "decay", exact_option("decay", self.decay))
        if option_number(self.decay, exact=False) < 0.0:
            raise ArgumentError("decay", "at least 0", self.decay)

    def data(self, model: Any, *, exact: bool = False, bound: str = "high") -> Data:
        """The model's arrays and the decay rate."""
        decay = option_number(self.decay, exact=exact)
        return {**super().data(model, exact=exact, bound=bound), "decay": decay}

    def vertex_matrices(self, model: Any, values: Any) -> Any:
        """P (m, n, n) with V(x) = x^T (sum_r sigma_r P_r) x; what a region of attraction needs."""
        return values["P"]


def one_per_vertex(model: Any) -> Unknowns:
    """P (m, n, n)."""
    return _stack(model.states, model.count)


@lru_cache(maxsize=64)
def _stack(states: int, count: int) -> Unknowns:
    return Unknowns((Unknown("P", states, count=count, symmetric=True),))


@lru_cache(maxsize=64)
def _pairs(count: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    return np.triu_indices(count)


def weighted(phi: Any, matrices: Any) -> Any:
    """sum_r phi_r M_r over the third axis from the end."""
    return (phi[..., :, None, None] * matrices).sum(axis=-3)


def pair_products(P: Any, A: Any, data: Data) -> Any:
    """1/2 He(P_i A_j + P_j A_i) + decay (P_i + P_j) for all i <= j, stacked (..., pairs, n, n)."""
    symmetric = he(P[..., :, None, :, :] @ A[..., None, :, :, :])
    first, second = _pairs(P.shape[-3])
    mixed = data["half"] * (symmetric[..., first, second, :, :] + symmetric[..., second, first, :, :])
    if data["decay"] == 0:
        return mixed
    return mixed + data["decay"] * (P[..., first, :, :] + P[..., second, :, :])
