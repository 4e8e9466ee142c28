"""Exact solution of a two-dimensional quadratic programme in a box, as branch-free CasADi expressions."""

from typing import Any

import casadi

Expression = Any


def minimise_in_box(
    hessian: Expression, gradient: Expression, low: Expression, high: Expression
) -> tuple[Expression, Expression]:
    """Minimise ``d' hessian d / 2 + gradient' d`` over ``low <= d <= high``.

    hessian: 2x2 positive definite; gradient, low, high: (2,). Returns the minimiser (2,) and flags (2,)
    that are 1 where the component is not held by its bound. The minimiser is the free one if it lies in
    the box, else the best of the minimisers on the four edges; corners are the ends of edges.
    """
    first, cross, second = hessian[0, 0], hessian[0, 1], hessian[1, 1]
    determinant = first * second - cross * cross
    free = casadi.vertcat(cross * gradient[1] - second * gradient[0], cross * gradient[0] - first * gradient[1])
    free = free / determinant

    def value(step: Expression) -> Expression:
        quadratic = first * step[0] ** 2 + 2 * cross * step[0] * step[1] + second * step[1] ** 2
        return quadratic / 2 + gradient[0] * step[0] + gradient[1] * step[1]

    def clip(component: Expression, index: int) -> Expression:
        return casadi.fmin(casadi.fmax(component, low[index]), high[index])

    edges = []
    for bound in (low, high):
        along = -(gradient[1] + cross * bound[0]) / second
        kept = clip(along, 1)
        edges.append((casadi.vertcat(bound[0], kept), casadi.vertcat(0, along == kept)))
        along = -(gradient[0] + cross * bound[1]) / first
        kept = clip(along, 0)
        edges.append((casadi.vertcat(kept, bound[1]), casadi.vertcat(along == kept, 0)))

    best, flags = edges[0]
    least = value(best)
    for step, step_flags in edges[1:]:
        candidate = value(step)
        better = candidate < least
        best = casadi.if_else(better, step, best)
        flags = casadi.if_else(better, step_flags, flags)
        least = casadi.if_else(better, candidate, least)

    inside = casadi.logic_and(free[0] >= low[0], free[0] <= high[0])
    inside = casadi.logic_and(inside, casadi.logic_and(free[1] >= low[1], free[1] <= high[1]))
    return casadi.if_else(inside, free, best), casadi.if_else(inside, casadi.DM([1, 1]), flags)
