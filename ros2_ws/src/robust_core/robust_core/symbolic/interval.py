"""CasADi functions in interval arithmetic: python-flint balls instead of floats."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from robust_core.errors import EnclosureError
from robust_core.rational import Floats
from robust_core.symbolic.packages import casadi_module, flint_module

_CONSTANT_SLACK = 2.0**-50
"""Relative radius of constants that are no short binary fractions: 0.6 stands for 3/5, folded products for theirs."""


class BallFunction:
    """Outputs of a scalar CasADi function over a box of inputs, beyond doubt.

    The balls contain every value that the function takes for inputs in the box and for constants within a few last
    digits, so that decimal constants may be read as written.

    Raises
    ------
    EnclosureError: if the function uses an operation that has no interval form here (a switch, for example).
    """

    def __init__(self, expressions: Any, variables: Any) -> None:
        casadi = casadi_module()
        flint = flint_module()
        function = casadi.Function("f", [variables], [casadi.densify(casadi.vec(expressions))])
        self.outputs = int(function.numel_out(0))
        self._registers = int(function.sz_w()) + 1
        self._steps: list[tuple[Callable[..., Any] | None, int, tuple[int, ...], Any]] = []
        operations = _operations(casadi, flint)
        for k in range(function.n_instructions()):
            kind = function.instruction_id(k)
            ins, outs = function.instruction_input(k), function.instruction_output(k)
            if kind == casadi.OP_CONST:
                self._steps.append((None, outs[0], (), _constant(flint, float(function.instruction_constant(k)))))
            elif kind == casadi.OP_INPUT:
                self._steps.append((None, outs[0], (ins[1],), "input"))
            elif kind == casadi.OP_OUTPUT:
                self._steps.append((None, outs[1], (ins[0],), "output"))
            elif kind in operations:
                self._steps.append((operations[kind], outs[0], tuple(ins), None))
            else:
                raise EnclosureError(
                    f"no interval arithmetic for CasADi operation {kind}: use smooth functions without switches"
                )

    def __call__(self, balls: Sequence[Any]) -> list[Any]:
        """Balls of all outputs for balls of all inputs."""
        work: list[Any] = [None] * self._registers
        out: list[Any] = [flint_module().arb(0)] * self.outputs
        for operation, target, sources, extra in self._steps:
            if operation is not None:
                work[target] = operation(*[work[k] for k in sources])
            elif extra == "input":
                work[target] = balls[sources[0]]
            elif extra == "output":
                out[target] = work[sources[0]]
            else:
                work[target] = extra
        return out


def box_balls(low: Floats, high: Floats) -> list[Any]:
    """One ball per side of a box."""
    arb = flint_module().arb
    middle = 0.5 * (low + high)
    radius = np.nextafter(np.maximum(high - middle, middle - low), np.inf)
    return [arb(m, r) if r > 5e-324 else arb(m) for m, r in zip(middle.tolist(), radius.tolist(), strict=True)]


def middles_and_radii(balls: Sequence[Any]) -> tuple[Floats, Floats]:
    """Floats m, r with every ball inside [m - r, m + r].

    Raises
    ------
    EnclosureError: if a ball is not finite: a pole, or the root of a negative number, is within the box.
    """
    middles, radii = np.empty(len(balls)), np.empty(len(balls))
    for k, ball in enumerate(balls):
        if not ball.is_finite():
            raise EnclosureError(
                "an expression has no finite enclosure in a part of the box: it has a pole there, or none"
            )
        middles[k] = middle = float(ball.mid())
        radii[k] = float(abs(ball - middle).upper())
    return middles, np.nextafter(radii * (1.0 + 2.0**-50), np.inf)


def _constant(flint: Any, value: float) -> Any:
    scaled = np.frexp(value)[0] * 2.0**26
    if scaled == np.round(scaled):
        return flint.arb(value)
    return flint.arb(value, abs(value) * _CONSTANT_SLACK)


def _operations(casadi: Any, flint: Any) -> dict[int, Callable[..., Any]]:
    one = flint.arb(1)
    return {
        casadi.OP_ASSIGN: lambda a: a,
        casadi.OP_ADD: lambda a, b: a + b,
        casadi.OP_SUB: lambda a, b: a - b,
        casadi.OP_MUL: lambda a, b: a * b,
        casadi.OP_DIV: lambda a, b: a / b,
        casadi.OP_NEG: lambda a: -a,
        casadi.OP_INV: lambda a: one / a,
        casadi.OP_SQ: lambda a: a**2,
        casadi.OP_TWICE: lambda a: a + a,
        casadi.OP_SQRT: lambda a: a.sqrt(),
        casadi.OP_SIN: lambda a: a.sin(),
        casadi.OP_COS: lambda a: a.cos(),
        casadi.OP_TAN: lambda a: a.tan(),
        casadi.OP_SINH: lambda a: a.sinh(),
        casadi.OP_COSH: lambda a: a.cosh(),
        casadi.OP_TANH: lambda a: a.tanh(),
        casadi.OP_ASIN: lambda a: a.asin(),
        casadi.OP_ACOS: lambda a: a.acos(),
        casadi.OP_ATAN: lambda a: a.atan(),
        casadi.OP_EXP: lambda a: a.exp(),
        casadi.OP_LOG: lambda a: a.log(),
        casadi.OP_POW: lambda a, b: a**b,
        casadi.OP_CONSTPOW: lambda a, b: a**b,
        casadi.OP_FABS: abs,
    }
