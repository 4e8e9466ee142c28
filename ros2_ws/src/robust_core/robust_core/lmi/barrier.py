"""Best margins of many small LMIs of one shape at once: a barrier method on stacked arrays.

max t with F_k(y) - t w_k I > 0 and fixed size, by damped Newton steps on -kappa t - sum_k log det. Every step gives a
lower bound (its own t) and, near the central path, multipliers with an upper bound; a problem is dropped as soon as the
sign of t is known.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robust_core.lmi.small_matrices import Triangle, inverse, largest_step, least_eigenvalue
from robust_core.rational import Floats

_GROWTH = 8.0
_NEAR = 0.5


@dataclass(frozen=True, slots=True)
class Stack:
    """One constraint of N problems: coefficients (N, size, K, n, n) of the unknowns, and its share of the margin."""

    linear: Floats
    weight: float
    sized: bool


@dataclass(frozen=True, slots=True)
class BatchSolution:
    """Bounds (N,) of the best margins, y (N, size), and multipliers (N, K, n, n) of each constraint.

    ``lower`` > 0: the y of that problem is a solution. ``upper`` < 0: its multipliers rule one out. Both may be open
    where the iterations ran out.
    """

    lower: Floats
    upper: Floats
    vectors: Floats
    multipliers: tuple[Floats, ...]


def best_margins(stacks: Sequence[Stack], *, iterations: int = 120, tolerance: float = 1e-7) -> BatchSolution:
    """Decide the signs of the best margins of N homogeneous LMIs.

    All constraints that are sized must have the same coefficients in every problem, as P > 0 has.
    """
    run = _Run(stacks)
    for _ in range(iterations):
        if not run.step(tolerance):
            break
    return run.solution()


class _Run:
    def __init__(self, stacks: Sequence[Stack]) -> None:
        self.stacks = stacks
        count, size = stacks[0].linear.shape[:2]
        sized = [stack for stack in stacks if stack.sized]
        self.normal = np.asarray(
            sum(np.trace(stack.linear[0], axis1=-2, axis2=-1).sum(axis=-1) for stack in sized), dtype=np.float64
        )
        self.total = float(sum(stack.linear.shape[2] * stack.linear.shape[3] for stack in sized))
        start = self.normal * self.total / (self.normal @ self.normal)
        # Directions that keep the size, and the margin as the last one.
        complement = np.linalg.qr(np.column_stack([self.normal, np.eye(size)]))[0][:, 1:size]
        self.basis, self.start = complement, start
        self.triangles = [Triangle(stack.linear.shape[-1]) for stack in stacks]
        self.base, self.directions = [], []
        margin = np.full(count, np.inf)
        for stack, triangle in zip(stacks, self.triangles, strict=True):
            flat = triangle.pack(stack.linear)
            base = np.einsum("nvkp,v->nkp", flat, start)
            moves = np.einsum("nvkp,vw->nkpw", flat, complement)
            identity = triangle.pack(np.eye(triangle.size))
            drop = np.broadcast_to(-stack.weight * identity[:, None], (*moves.shape[:3], 1))
            self.base.append(base)
            self.directions.append(np.ascontiguousarray(np.concatenate([moves, drop], axis=-1)))
            margin = np.minimum(margin, (least_eigenvalue(triangle.unpack(base)) / stack.weight).min(axis=-1))
        self.barrier = float(sum(stack.linear.shape[2] * stack.linear.shape[3] for stack in stacks))
        # First margins as far below the best at the start as blocks are large.
        self.point = np.zeros((count, size))
        self.point[:, -1] = margin - np.maximum(1.0, np.abs(margin))
        self.kappa = self.barrier / np.maximum(1.0, np.abs(margin))
        self.active = np.arange(count)
        self.lower, self.upper = np.full(count, -np.inf), np.full(count, np.inf)
        self.vectors = np.zeros((count, size))
        self.multipliers = [np.zeros((*stack.linear.shape[:1], *stack.linear.shape[2:])) for stack in stacks]

    def step(self, tolerance: float) -> bool:
        """One Newton step of all problems that are open; False when none is left."""
        weights, gradient, hessian, slacks = self._newton_system()
        gradient[:, -1] -= self.kappa
        move = -np.linalg.solve(hessian, gradient[..., None])[..., 0]
        decrement = np.sqrt(np.maximum(-(gradient * move).sum(axis=1), 0.0))
        changes = [np.einsum("nkpw,nw->nkp", d, move) for d in self.directions]
        longest = np.full(len(move), np.inf)
        for triangle, slack, change in zip(self.triangles, slacks, changes, strict=True):
            longest = np.minimum(longest, largest_step(triangle.unpack(slack), triangle.unpack(change)))
        damped = np.maximum(1.0 / (1.0 + decrement), np.minimum(1.0, 0.7 * longest))
        length = np.where(decrement < _NEAR, np.minimum(1.0, 0.95 * longest), np.minimum(damped, 0.95 * longest))
        self._bound_above(weights, changes, decrement, self.point[:, -1].copy())
        self.point += length[:, None] * move
        open_problems = self._bound_below(tolerance)
        self.kappa = np.where(decrement < _NEAR, self.kappa * _GROWTH, self.kappa)
        if not open_problems.all():
            self._keep(open_problems)
        return bool(open_problems.any())

    def _newton_system(self) -> tuple[list[Floats], Floats, Floats, list[Floats]]:
        count, size = self.point.shape
        gradient, hessian = np.zeros((count, size)), np.zeros((count, size, size))
        weights, slacks = [], []
        for triangle, base, directions in zip(self.triangles, self.base, self.directions, strict=True):
            slack = base + np.einsum("nkpw,nw->nkp", directions, self.point)
            W = inverse(triangle.unpack(slack))
            flat = directions.reshape(count, -1, size)
            bent = np.matmul(triangle.congruence(W), directions).reshape(count, -1, size)
            hessian += np.matmul(flat.transpose(0, 2, 1), bent)
            gradient -= np.matmul(triangle.pack(W).reshape(count, 1, -1), flat)[:, 0]
            weights.append(W)
            slacks.append(slack)
        return weights, gradient, hessian, slacks

    def _bound_above(self, weights: list[Floats], changes: list[Floats], decrement: Floats, margin: Floats) -> None:
        """Multipliers W - W dS W over kappa meet the equations exactly, and are positive where the decrement is < 1."""
        near = decrement < 0.95
        rows = np.flatnonzero(near)
        if not rows.size:
            return
        slope = np.zeros(len(rows))
        found = []
        for W, change, triangle in zip(weights, changes, self.triangles, strict=True):
            inner, moved = W[rows], triangle.unpack(change[rows])
            found.append((inner - inner @ moved @ inner) / self.kappa[rows, None, None, None])
            slope += (inner * moved).sum(axis=(1, 2, 3))
        bound = margin[rows] + (self.barrier - slope) / self.kappa[rows]
        better = bound < self.upper[self.active[rows]]
        places = self.active[rows][better]
        self.upper[places] = bound[better]
        share = -bound[better] / self.total
        for store, Z, stack in zip(self.multipliers, found, self.stacks, strict=True):
            chosen = Z[better]
            if stack.sized:
                chosen = chosen + np.maximum(share, 0.0)[:, None, None, None] * np.eye(Z.shape[-1])
            store[places] = chosen

    def _bound_below(self, tolerance: float) -> np.ndarray:
        margin = self.point[:, -1]
        better = margin > self.lower[self.active]
        places = self.active[better]
        self.lower[places] = margin[better]
        self.vectors[places] = self.point[better][:, :-1] @ self.basis.T + self.start
        lower, upper = self.lower[self.active], self.upper[self.active]
        decided = (lower > 0.0) | (upper < 0.0)
        return np.asarray(~decided & (upper - lower > tolerance))

    def _keep(self, rows: np.ndarray) -> None:
        self.active, self.point, self.kappa = self.active[rows], self.point[rows], self.kappa[rows]
        self.base = [base[rows] for base in self.base]
        self.directions = [directions[rows] for directions in self.directions]

    def solution(self) -> BatchSolution:
        return BatchSolution(self.lower, self.upper, self.vectors, tuple(self.multipliers))
