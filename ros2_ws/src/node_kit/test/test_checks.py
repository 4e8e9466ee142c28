"""The checks that all conversions share."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from node_kit import RejectedMessage
from node_kit.conversions.checks import checked_covariance, covariance_problem, require_frame, require_unit_quaternion

FACTORS = arrays(np.float64, (6, 6), elements=st.floats(-1.0, 1.0, width=32))
SCALES = arrays(np.float64, 6, elements=st.sampled_from([0.0, 1e-9, 1e-3, 1.0, 1e6]))


@given(FACTORS, SCALES)
def test_every_gramian_is_a_covariance_whatever_its_units(factor, scales):
    root = factor * scales[:, None]
    covariance = root @ root.T
    assert covariance_problem(((covariance + covariance.T) / 2.0).tolist()) is None


@given(FACTORS, SCALES.filter(np.all), st.integers(0, 5))
def test_a_negative_direction_is_found(factor, scales, index):
    covariance = factor @ factor.T + np.eye(6)
    values, vectors = np.linalg.eigh(covariance)
    values[index] = -0.01 * values.max()
    broken = (vectors * values) @ vectors.T
    broken = (broken + broken.T) / 2.0 * np.outer(scales, scales)
    assert covariance_problem(broken.tolist()) in ("not positive semi-definite", "negative variance")


@given(st.lists(st.lists(st.floats(), min_size=3, max_size=3), min_size=3, max_size=3))
def test_any_floats_get_a_verdict(matrix):
    problem = covariance_problem(matrix)
    if problem is None:
        assert np.isfinite(matrix).all()
        assert (np.diag(matrix) >= 0.0).all()


@pytest.mark.parametrize(
    ("matrix", "problem"),
    [
        ([[1.0, 0.5], [0.4, 1.0]], "not symmetric"),
        ([[1.0, 0.5], [0.0, 1.0]], "not symmetric"),
        ([[1.0, 2.0], [2.0, 1.0]], "not positive semi-definite"),
        ([[0.0, 0.1], [0.1, 1.0]], "not positive semi-definite"),
        ([[-1e-12, 0.0], [0.0, 1.0]], "negative variance"),
        ([[1.0, math.nan], [math.nan, 1.0]], "not finite"),
        ([[math.inf, 0.0], [0.0, 1.0]], "not finite"),
        ([[1e308, 1e308], [1e308, 1e308]], None),
        ([[5e-324, 0.0], [0.0, 0.0]], None),
        ([[1.0, 1.0], [1.0, 1.0]], None),
    ],
)
def test_covariance_verdicts(matrix, problem):
    assert covariance_problem(matrix) == problem


def test_covariance_of_the_wrong_size_is_refused():
    with pytest.raises(RejectedMessage, match="size of c is 9, expected 36"):
        checked_covariance("c", np.zeros(9), 6)


def test_checked_covariance_cannot_be_changed_by_its_reader():
    with pytest.raises(ValueError, match="read-only"):
        checked_covariance("c", np.eye(3).ravel(), 3)[0, 0] = 2.0


@given(st.tuples(*[st.floats()] * 4))
def test_quaternions_are_unit_or_refused(components):
    if all(map(math.isfinite, components)) and abs(math.hypot(*components) - 1.0) < 0.01:
        assert math.hypot(*require_unit_quaternion("q", *components)) == pytest.approx(1.0)
    else:
        with pytest.raises(RejectedMessage, match=r"quaternion norm is not 1: q|not finite: q"):
            require_unit_quaternion("q", *components)


@pytest.mark.parametrize(("frame", "reason"), [("", "empty frame"), ("/odom", "frame starts with a slash")])
def test_bad_frames_are_refused(frame, reason):
    with pytest.raises(RejectedMessage, match=reason):
        require_frame("header", frame)
