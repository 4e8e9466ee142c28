"""Weights and vertices from nonlinear terms, each between two bounds."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.errors import ArgumentError
from robust_core.models import Simplices
from robust_core.rational import Floats
from robust_core.symbolic.packages import casadi_module
from robust_core.symbolic.supremum import Supremum
from robust_core.symbolic.system import StateDependentModel


@dataclass(frozen=True, slots=True)
class Term:
    """A nonlinear term of A or B (a CasADi expression), and its bounds over the box; None lets them be enclosed."""

    expression: Any
    low: float | None = None
    high: float | None = None


def derive(
    *,
    states: Any,
    low: Any,
    high: Any,
    terms: Sequence[Term],
    matrix: Callable[..., Any],
    input_matrix: Callable[..., Any] | None = None,
    parameters: Any = None,
    variables: Any = None,
    motion: Any = None,
) -> StateDependentModel:
    """A polytopic model whose weights come in pairs, one pair per nonlinear term.

    With A affine in the terms t_k, A = A_0 + sum_k t_k A_k, and K terms between l_k and h_k, pair k has the vertices
    A_0 + K l_k A_k and A_0 + K h_k A_k and the weights (h_k - t_k) / (K (h_k - l_k)) and its complement to 1/K.

    Parameters
    ----------
    matrix, input_matrix: A and B as functions of the terms, in their order.
    variables, motion: what the terms depend on and its time derivative, where that is not the state.

    Raises
    ------
    ArgumentError: if a matrix is not affine in the terms, or a term has no room between its bounds.
    """
    casadi = casadi_module()
    if not terms:
        raise ArgumentError("terms", "at least one nonlinear term", "none", "a linear system needs no polytope")
    v = states if variables is None else variables
    symbols = [casadi.SX.sym(f"t{k}") for k in range(len(terms))]
    bounds = [_bounds(term, v, np.asarray(low, dtype=float), np.asarray(high, dtype=float)) for term in terms]
    expressions = [casadi.SX(term.expression) for term in terms]
    weights, share = [], 1.0 / len(terms)
    for expression, (lower, upper) in zip(expressions, bounds, strict=True):
        weights += [share * (upper - expression) / (upper - lower), share * (expression - lower) / (upper - lower)]
    stack, corners = casadi.vertcat(*symbols), []
    for k, (lower, upper) in enumerate(bounds):
        for bound in (lower, upper):
            corner = casadi.DM.zeros(len(terms))
            corner[k] = len(terms) * bound
            corners.append(corner)

    def at(values: Any, symbolic: Any) -> Any:
        return casadi.substitute(symbolic, stack, values)

    A = _affine("matrix", casadi.SX(matrix(*symbols)), stack)
    B = None if input_matrix is None else _affine("input_matrix", casadi.SX(input_matrix(*symbols)), stack)
    return StateDependentModel.of(
        states=states,
        low=low,
        high=high,
        matrix=at(casadi.vertcat(*expressions), A),
        input_matrix=None if B is None else at(casadi.vertcat(*expressions), B),
        weights=casadi.vertcat(*weights),
        vertices=[at(corner, A) for corner in corners],
        inputs=None if B is None else [at(corner, B) for corner in corners],
        variables=variables,
        motion=motion,
        groups=Simplices.of(2 * len(terms), [(2 * k, 2 * k + 1) for k in range(len(terms))]).groups,
        parameters=parameters,
    )


def _affine(name: str, matrix: Any, symbols: Any) -> Any:
    casadi = casadi_module()
    if casadi.depends_on(casadi.jacobian(casadi.vec(matrix), symbols), symbols):
        raise ArgumentError(name, "affine in the terms", "products of them", "make the product a term of its own")
    return matrix


def _bounds(term: Term, variables: Any, low: Floats, high: Floats) -> tuple[float, float]:
    casadi = casadi_module()
    lower, upper = term.low, term.high
    if lower is None or upper is None:
        both = Supremum(casadi.SX(term.expression), variables)
        _, ends = both.enclose(low, high, np.array([[1.0], [-1.0]]))
        lower, upper = (-float(ends[1]) if lower is None else lower), (float(ends[0]) if upper is None else upper)
    if not (np.isfinite(lower) and np.isfinite(upper) and lower < upper):
        raise ArgumentError("terms", "each with low below high", f"{lower} to {upper}", "leave out constant terms")
    return lower, upper
