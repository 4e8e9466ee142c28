"""Exact numbers and the exact decision whether a matrix is positive definite."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robust_core import rational as rational_module
from robust_core.errors import ArgumentError
from robust_core.rational import definite, exact_array, rational, solve_exact, to_float, to_text

ENTRIES = st.lists(st.integers(-4, 4), min_size=9, max_size=9)


@pytest.fixture(params=["flint", "fractions"])
def arithmetic(request, monkeypatch) -> str:
    """Both kinds of exact numbers."""
    if request.param == "fractions":
        monkeypatch.setattr(rational_module, "_fmpq", None)
    elif rational_module._fmpq is None:
        pytest.skip("python-flint is optional")
    return request.param


def test_texts_mean_decimals_and_floats_their_binary_value(arithmetic) -> None:
    assert rational("0.6") == rational(Fraction(3, 5))
    assert rational(0.6) != rational("0.6")
    assert rational(0.25) == rational("1/4")


@pytest.mark.parametrize("bad", [math.nan, math.inf, "x", None, "1/0", [1]])
def test_what_is_no_finite_number_is_refused(arithmetic, bad) -> None:
    with pytest.raises(ArgumentError, match="finite"):
        rational(bad)


def test_texts_and_floats_survive_the_round_trip(arithmetic) -> None:
    numbers = exact_array([["-10/7", 3], ["0.1", "1e-30"]])
    assert (exact_array(to_text(numbers)).reshape(2, 2) == numbers).all()
    assert to_float(numbers).tolist() == [[-10 / 7, 3.0], [0.1, 1e-30]]


def test_numbers_beyond_floats_are_refused(arithmetic) -> None:
    with pytest.raises(ArgumentError, match="range"):
        to_float(exact_array(["1e400"]))


@given(ENTRIES)
def test_definiteness_agrees_with_minors(entries) -> None:
    root = np.array(entries).reshape(3, 3)
    for shift in (-1, 0, 1):
        matrix = root @ root.T + shift * np.eye(3, dtype=int)
        minors = [round(float(np.linalg.det(matrix[:k, :k]))) for k in (1, 2, 3)]
        assert bool(definite(exact_array(matrix))) == all(minor > 0 for minor in minors)
        lowest = float(np.linalg.eigvalsh(matrix).min())
        if abs(lowest) > 1e-9:
            assert bool(definite(exact_array(matrix), strict=False)) == (lowest > 0)


@pytest.mark.parametrize(
    ("matrix", "strict", "semi"),
    [
        ([[0]], False, True),
        ([[1, 1], [1, 1]], False, True),
        ([[0, 1], [1, 0]], False, False),
        ([[0, 0], [0, 1]], False, True),
        ([[1, 0], [0, -1]], False, False),
        ([[0, 0, 0], [0, 1, 2], [0, 2, 4]], False, True),
        ([["1e-300", 0], [0, "1e300"]], True, True),
    ],
)
def test_definiteness_of_borderline_matrices(arithmetic, matrix, strict, semi) -> None:
    exact = exact_array(matrix)
    assert bool(definite(exact)) is strict
    assert bool(definite(exact, strict=False)) is semi


def test_rounding_that_floats_cannot_see_decides(arithmetic) -> None:
    nearly = exact_array([[1, 1], [1, 1]])
    nearly[1, 1] = nearly[1, 1] + rational("1e-40")
    assert definite(nearly)
    nearly[1, 1] = nearly[1, 1] - rational("2e-40")
    assert not definite(nearly, strict=False)


def test_stacks_are_judged_one_by_one(arithmetic) -> None:
    stack = exact_array([[[1, 0], [0, 1]], [[1, 2], [2, 1]], [[-1, 0], [0, 1]]])
    assert definite(stack).tolist() == [True, False, False]


def test_exact_systems_are_solved_with_swapped_pivots(arithmetic) -> None:
    matrix = exact_array([[0, 2, 1], [1, 1, 0], [3, 0, "1/3"]])
    solution = exact_array(["1/7", -2, 5])
    assert (solve_exact(matrix, matrix @ solution) == solution).all()


def test_singular_systems_are_refused(arithmetic) -> None:
    with pytest.raises(ArgumentError, match="singular"):
        solve_exact(exact_array([[1, 2], [2, 4]]), exact_array([1, 1]))
