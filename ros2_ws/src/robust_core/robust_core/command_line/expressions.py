"""Formulas in specifications: arithmetic and a few functions, read by a parser that runs no code.

The text is parsed, and only numbers, names, + - * / ** (or ^), brackets and the functions below are let through.
"""

import ast
import math
from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

from robust_core.errors import ArgumentError

FUNCTIONS = ("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "sqrt")
CONSTANTS = {"pi": math.pi}
_LENGTH = 1000
_LARGEST_POWER = 32

_BINARY: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: lambda a, b: a + b,
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b,
    ast.Div: lambda a, b: a / b,
}


class FormulaError(ArgumentError):
    """A text is not a formula, or names what does not exist."""

    def __init__(self, text: str, why: str) -> None:
        super().__init__(
            "formula",
            f"made of numbers, names, + - * / ^, brackets and {', '.join(FUNCTIONS)}",
            repr(text if len(text) < 80 else text[:77] + "..."),
            why,
        )


def evaluate(text: Any, names: Mapping[str, Any], functions: Callable[[str], Callable[[Any], Any]]) -> Any:
    """The value of a formula, whose numbers are Fractions and whose names stand for the values given.

    Raises
    ------
    FormulaError: for anything that is not such a formula; nothing of it is run.
    """
    source = text if isinstance(text, str) else repr(text)
    if len(source) > _LENGTH:
        raise FormulaError(source, f"it is longer than {_LENGTH} characters: name parts of it")
    try:
        tree = ast.parse(source.strip().replace("^", "**"), mode="eval")
        return _Reader(source, names, functions).value(tree.body)
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        if isinstance(error, FormulaError):
            raise
        raise FormulaError(source, f"it cannot be read ({type(error).__name__})") from error
    except (ZeroDivisionError, OverflowError) as error:
        raise FormulaError(source, f"it has no finite value ({error})") from error


def number(text: Any) -> Fraction | float:
    """A constant: an exact Fraction, or a float where a function or pi is involved.

    >>> number("0.6*100 - 0.4"), number("pi/40") < 0.0786
    (Fraction(298, 5), True)
    """
    value = evaluate(text, {}, _math)
    if isinstance(value, complex) or not math.isfinite(value):
        raise FormulaError(str(text), "it has no finite real value")
    return value if isinstance(value, Fraction) else float(value)


def formula(text: Any, names: Mapping[str, Any]) -> Any:
    """A CasADi expression of the named symbols."""
    from robust_core.symbolic.packages import casadi_module

    casadi = casadi_module()
    value = evaluate(text, names, lambda name: getattr(casadi, name))  # only names of FUNCTIONS arrive
    return casadi.SX(float(value)) if isinstance(value, Fraction | float) else value


def _math(name: str) -> Callable[[Any], Any]:
    function: Callable[[Any], Any] = getattr(math, name)
    return function


class _Reader:
    """Values of the nodes that are allowed."""

    def __init__(self, text: str, names: Mapping[str, Any], functions: Callable[[str], Callable[[Any], Any]]) -> None:
        self.text, self.names, self.functions = text, names, functions

    def value(self, node: ast.expr) -> Any:
        """Value of one node."""
        match node:
            case ast.Constant(value=value) if type(value) in (int, float):
                return Fraction(repr(value))
            case ast.Name(id=name):
                return self._named(name)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return -self.value(operand)
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self.value(operand)
            case ast.BinOp(left=left, op=ast.Pow(), right=right):
                return self._power(self.value(left), self.value(right))
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
                return _BINARY[type(op)](*_alike(self.value(left), self.value(right)))
            case ast.Call(func=ast.Name(id=name), args=[argument], keywords=[]) if name in FUNCTIONS:
                value = self.value(argument)
                return self.functions(name)(float(value) if isinstance(value, Fraction) else value)
        raise FormulaError(self.text, f"{ast.unparse(node)!r} is not allowed")

    def _named(self, name: str) -> Any:
        if name in self.names:
            return self.names[name]
        if name in CONSTANTS:
            return CONSTANTS[name]
        known = ", ".join([*self.names, *CONSTANTS]) or "none"
        raise FormulaError(self.text, f"{name!r} is no name here; known are {known}")

    def _power(self, base: Any, exponent: Any) -> Any:
        if not isinstance(exponent, (Fraction, float)) or not -_LARGEST_POWER <= exponent <= _LARGEST_POWER:
            raise FormulaError(self.text, f"exponents are numbers within +-{_LARGEST_POWER}")
        if isinstance(exponent, Fraction) and exponent.denominator == 1:
            return base ** int(exponent)
        return (float(base) if isinstance(base, Fraction) else base) ** float(exponent)


def _alike(left: Any, right: Any) -> tuple[Any, Any]:
    """Fractions stay exact among themselves; beside anything else they are floats."""
    if isinstance(left, Fraction) and not isinstance(right, Fraction):
        return float(left), right
    if isinstance(right, Fraction) and not isinstance(left, Fraction):
        return left, float(right)
    return left, right
