"""Formulas of specifications: exact numbers, and nothing that is code."""

from fractions import Fraction

import casadi
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robust_core.command_line.expressions import FormulaError, formula, number


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("-10/7", Fraction(-10, 7)),
        (0.1, Fraction(1, 10)),
        ("1e-3", Fraction(1, 1000)),
        ("2^3 - 2**-1", Fraction(15, 2)),
        ("+(1 - 2)*3", Fraction(-3)),
        ("4^(1/2)", 2.0),
        ("2*cos(0)", 2.0),
        ("sqrt(4) + 1", 3.0),
    ],
)
def test_numbers_are_exact_where_they_can_be(text, value) -> None:
    found = number(text)
    assert found == value and type(found) is type(value)


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os').system('true')",
        "().__class__",
        "x.y",
        "x[0]",
        "[1]",
        "lambda: 1",
        "1 if 1 else 2",
        "f'{1}'",
        "'a'",
        "True",
        "1j",
        "1 < 2",
        "1 // 2",
        "1 % 2",
        "1 and 2",
        "a := 1",
        "sin(1, 2)",
        "sin(x=1)",
        "sin(*[1])",
        "eval(1)",
        "open(1)",
        "9^9^9",
        "2^1000",
        "2^x",
        "1/0",
        "0^-1",
        "(-8)^(1/3)",
        "exp(1000)",
        "exp(exp(100))",
        "log(-1)",
        "nan",
        "1e999",
        "",
        " ",
        "1 +",
        "(" * 300 + "1" + ")" * 300,
        "-" * 990 + "1",
        "1" * 2000,
        "\x00",
        None,
        [1],
    ],
)
def test_nothing_else_is_read(text) -> None:
    with pytest.raises(FormulaError):
        number(text)


def test_formulas_become_expressions_of_the_named_symbols() -> None:
    x = casadi.SX.sym("x")
    made = formula("2*sin(x)^2 + x/4 - 1.5", {"x": x})
    value = float(casadi.Function("f", [x], [made])(0.3))
    assert value == pytest.approx(2 * 0.29552020666**2 + 0.075 - 1.5)
    assert float(formula("3/4", {})) == 0.75
    with pytest.raises(FormulaError, match="known are x, pi"):
        formula("y", {"x": x})
    with pytest.raises(FormulaError, match="exponents are numbers"):
        formula("2^x", {"x": x})


@given(st.text(max_size=40))
def test_any_text_is_a_number_or_refused(text) -> None:
    try:
        found = number(text)
    except FormulaError:
        return
    assert isinstance(found, Fraction | float)
