"""A state-dependent system written down once, as formulas."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from robust_core.checks import finite_array
from robust_core.errors import ArgumentError, RateError
from robust_core.models import PolytopicSystem, RateBounds, Simplices
from robust_core.rational import Floats
from robust_core.symbolic.packages import casadi_module
from robust_core.symbolic.rates import RateMap

Method = Literal["enclosed", "sampled"]


@dataclass(frozen=True, slots=True)
class StateDependentModel:
    """x' = sum_r sigma_r(v) (A_r x + B_r u) for v in a box, beside the original x' = A(v) x + B(v) u.

    All expressions are CasADi SX. ``variables`` (d, 1) are what the weights depend on, ``motion`` (d, 1) their time
    derivatives; for most systems variables are the states and motion is A x. ``weights`` (m, 1), ``vertices`` and
    ``inputs`` m matrices each, ``matrix`` and ``input_matrix`` the originals, None for no input. Everything may depend
    on ``parameters`` (p, 1), on which vertices and motion depend affinely where rates are enclosed for many of them.
    """

    variables: Any
    low: Floats
    high: Floats
    motion: Any
    matrix: Any
    input_matrix: Any
    weights: Any
    vertices: tuple[Any, ...]
    inputs: tuple[Any, ...] | None
    simplices: Simplices
    parameters: Any

    @staticmethod
    def of(
        *,
        states: Any,
        low: Any,
        high: Any,
        matrix: Any,
        weights: Any,
        vertices: Sequence[Any],
        input_matrix: Any = None,
        inputs: Sequence[Any] | None = None,
        variables: Any = None,
        motion: Any = None,
        groups: Sequence[Sequence[int]] | None = None,
        totals: Sequence[Any] | None = None,
        parameters: Any = None,
    ) -> "StateDependentModel":
        """A checked model with given weights and vertices; :func:`~robust_core.symbolic.sectors.derive` finds them.

        Raises
        ------
        ArgumentError: naming the argument that has the wrong size, or an empty or reversed box.
        RateError: if the rates of the weights depend on the input: bounds on them would be circular.
        """
        casadi = casadi_module()
        v = states if variables is None else variables
        n, d = int(states.numel()), int(v.numel())
        lower, upper = finite_array("low", low, (d,)), finite_array("high", high, (d,))
        if not (lower < upper).all():
            raise ArgumentError("high", "above low on every side of the box", f"{lower.tolist()} to {upper.tolist()}")
        if not (lower <= 0.0).all() or not (upper >= 0.0).all():
            raise ArgumentError("low", "a box that contains the origin", f"{lower.tolist()} to {upper.tolist()}")
        _sized("matrix", matrix, (n, n))
        sigma = casadi.vec(casadi.SX(weights))
        simplices = Simplices.of(int(sigma.numel()), groups, totals)
        if len(vertices) != simplices.count:
            raise ArgumentError("vertices", f"{simplices.count} matrices, one per weight", str(len(vertices)))
        for vertex in vertices:
            _sized("vertices", vertex, (n, n))
        if (input_matrix is None) != (inputs is None) or (inputs is not None and len(inputs) != len(vertices)):
            raise ArgumentError("inputs", "one matrix per weight, beside input_matrix", repr(inputs))
        flow = matrix @ states if motion is None else casadi.vec(motion)
        _sized("motion", flow, (d, 1))
        if input_matrix is not None and motion is None:
            pushed = casadi.jacobian(sigma, v) @ input_matrix
            if not casadi.simplify(pushed).is_zero():
                raise RateError(
                    "the rates of the weights depend on the input, so bounds on them would depend on the controller "
                    "they are for: give motion= with the input bounded, or use a theorem without rates"
                )
        p = casadi.SX.sym("none", 0) if parameters is None else parameters
        return StateDependentModel(
            v, lower, upper, flow, matrix, input_matrix, sigma, tuple(vertices),
            None if inputs is None else tuple(inputs), simplices, p,
        )  # fmt: skip

    @property
    def weight_rates(self) -> Any:
        """sigma' (m, 1) as expressions of variables and parameters."""
        casadi = casadi_module()
        return casadi.jacobian(self.weights, self.variables) @ self.motion

    def rate_map(self) -> RateMap:
        """What bounds the rates for many parameters at once."""
        return RateMap(self.weight_rates, self.variables, self.parameters, self.low, self.high)

    def rates(self, parameters: Any = (), *, method: Method = "enclosed", relative: float = 1e-6) -> RateBounds:
        """phi_r over the whole box for one set of parameters (1/s).

        "enclosed" is a proof (interval arithmetic), "sampled" is fast and only supports a verdict. The corners of the
        box alone would not do: for +-pi/2 in example 2.4.1 they give zero, and a false map (erratum 2.4.1-phi).
        """
        values = np.atleast_2d(finite_array("parameters", np.ravel(parameters), (None,)) if np.size(parameters) else [])
        return self.rate_map().bounds(values.reshape(1, -1), method=method, relative=relative)[0]

    def system(self, parameters: Any = (), *, rates: RateBounds | None = None) -> PolytopicSystem:
        """The polytopic model for one set of parameters, its vertices in floats."""
        casadi = casadi_module()
        values = np.ravel(np.asarray(parameters, dtype=np.float64))
        if values.size != int(self.parameters.numel()):
            raise ArgumentError("parameters", f"{int(self.parameters.numel())} numbers", f"{values.size}")
        numbers = casadi.Function("v", [self.parameters], [*self.vertices, *(self.inputs or ())])(values)
        stack = [np.array(matrix) for matrix in (numbers if isinstance(numbers, tuple | list) else [numbers])]
        count = self.simplices.count
        return PolytopicSystem.of(
            np.array(stack[:count]),
            None if self.inputs is None else np.array(stack[count:]),
            groups=self.simplices.groups,
            totals=self.simplices.totals,
            rates=rates,
        )


def _sized(name: str, expression: Any, shape: tuple[int, int]) -> None:
    if tuple(expression.shape) != shape:
        raise ArgumentError(name, f"of shape {shape}", f"shape {tuple(expression.shape)}")
