"""Random systems whose verdicts are known by construction, for tests and benchmarks of soundness."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from robust_core.models import PolytopicSystem
from robust_core.rational import Floats


@dataclass(frozen=True, slots=True)
class Sample:
    """A system, and whether a common Lyapunov function exists: True, False, or None where nobody knows."""

    model: PolytopicSystem
    feasible: bool | None
    made: str


def random_systems(
    seed: int, count: int, *, states: tuple[int, int] = (2, 6), vertices: tuple[int, int] = (2, 8), rates: bool = False
) -> Iterator[Sample]:
    """``count`` systems, a third of each kind: feasible, infeasible, unknown; the same for the same seed.

    Feasible ones are made from a common P. Infeasible ones have an unstable vertex, or stable vertices with an unstable
    mean; either rules out every theorem with P_r > 0 whose weights range over one simplex.
    """
    rng = np.random.default_rng(seed)
    for number in range(count):
        n, m = int(rng.integers(states[0], states[1] + 1)), int(rng.integers(vertices[0], vertices[1] + 1))
        scale = 10.0 ** rng.uniform(-3.0, 3.0)
        kind = number % 3
        if kind == 0:
            A, made = _with_common_p(rng, n, m), "from a common P"
        elif kind == 1:
            A, made = _unstable(rng, n, m)
        else:
            A, made = _shifted(rng, n, m), "random stable vertices"
        phi = scale * rng.uniform(0.0, 0.3, m) if rates else None
        yield Sample(PolytopicSystem.of(scale * A, rates=phi), (True, False, None)[kind], made)


def _coordinates(rng: np.random.Generator, n: int) -> Floats:
    """A change of coordinates with condition up to about 100."""
    q, _ = np.linalg.qr(rng.normal(size=(n, n)))
    return np.asarray(q * 10.0 ** rng.uniform(-1.0, 1.0, n), dtype=np.float64)


def _with_common_p(rng: np.random.Generator, n: int, m: int) -> Floats:
    """T^-1 (S - Q) T with S skew and Q > 0: P = T^T T serves all."""
    T = _coordinates(rng, n)
    skew = rng.normal(size=(m, n, n)) * 3.0
    root = rng.normal(size=(m, n, n))
    inner = skew - np.swapaxes(skew, 1, 2) - root @ np.swapaxes(root, 1, 2) - 0.1 * np.eye(n)
    return np.asarray(np.linalg.solve(T, inner @ T), dtype=np.float64)


def _shifted(rng: np.random.Generator, n: int, m: int) -> Floats:
    """Random matrices moved to the left until they are stable by a random little."""
    A = rng.normal(size=(m, n, n)) * 2.0
    rightmost = np.linalg.eigvals(A).real.max(axis=1)
    shift = rightmost + rng.uniform(0.05, 3.0, m)
    return np.asarray(A - shift[:, None, None] * np.eye(n), dtype=np.float64)


def _unstable(rng: np.random.Generator, n: int, m: int) -> tuple[Floats, str]:
    A = _with_common_p(rng, n, m)
    if rng.random() < 0.5:
        rightmost = np.linalg.eigvals(A[0]).real.max()
        A[0] += (rng.uniform(0.05, 1.0) - rightmost) * np.eye(n)
        return A, "with an unstable vertex"
    # Two nilpotent couplings, each stable beside -I, whose mean is not.
    T, coupling = _coordinates(rng, n), rng.uniform(2.5, 10.0)
    pair = np.repeat(-np.eye(n)[None], 2, axis=0)
    pair[0, 0, 1] = pair[1, 1, 0] = coupling
    A[:2] = np.linalg.solve(T, pair @ T)
    return A, "with an unstable mean of stable vertices"
