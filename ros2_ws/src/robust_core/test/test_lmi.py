"""Unknowns, cones, scaling and the solver underneath the theorems."""

import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robust_core.errors import ArgumentError, MissingDependencyError, SolverError, SolverLimitError
from robust_core.lmi import Constraint, Unknown, Unknowns, he
from robust_core.lmi.barrier import Stack, best_margins
from robust_core.lmi.coefficients import Family, coefficients
from robust_core.lmi.cones import Cone
from robust_core.lmi.constraint import blocks
from robust_core.lmi.margin import MarginSolver
from robust_core.lmi.objective import minimise
from robust_core.lmi.scaling import equilibrate
from robust_core.lmi.settings import SolverSettings
from robust_core.lmi.small_matrices import Triangle, inverse, largest_step, least_eigenvalue
from robust_core.rational import exact_array

UNKNOWNS = Unknowns((Unknown("P", 3, count=2, symmetric=True), Unknown("K", 1, 3), Unknown("g", 1)))


def lyapunov(A) -> tuple[Family, ...]:
    """P > 0 and PA + A'P < 0."""
    unknowns = Unknowns((Unknown("P", len(A), symmetric=True),))
    return coefficients(
        unknowns,
        lambda v: (
            Constraint("P > 0", v["P"][..., None, :, :], sized=True),
            Constraint("derivative", -he(v["P"] @ A)[..., None, :, :]),
        ),
    )


def test_unpack_and_pack_are_inverse_and_leading_axes_pass_through() -> None:
    vector = np.arange(2.0 * UNKNOWNS.size).reshape(2, -1)
    values = UNKNOWNS.unpack(vector)
    assert values["P"].shape == (2, 2, 3, 3)
    assert (values["P"] == np.swapaxes(values["P"], -1, -2)).all()
    for row in range(2):
        assert (UNKNOWNS.pack({k: v[row] for k, v in values.items()}) == vector[row]).all()
    assert (UNKNOWNS.unpack(exact_array(vector))["K"] == exact_array(values["K"])).all()


@pytest.mark.parametrize("values", [{}, {"P": np.zeros((2, 3, 3)), "K": np.zeros((3, 1)), "g": np.zeros((1, 1))}])
def test_values_of_other_shapes_are_refused(values) -> None:
    with pytest.raises(ArgumentError, match="of shape"):
        UNKNOWNS.pack(values)


def test_malformed_unknowns_are_refused() -> None:
    with pytest.raises(ArgumentError, match="square"):
        Unknown("P", 2, 3, symmetric=True)
    with pytest.raises(ArgumentError, match="positive size"):
        Unknown("P", 0)
    with pytest.raises(ArgumentError, match="different names"):
        Unknowns((Unknown("P", 1), Unknown("P", 2)))


@given(st.integers(1, 4), st.integers(1, 3), st.integers(0, 1000))
def test_rows_and_multipliers_keep_inner_products(size, count, seed) -> None:
    rng = np.random.default_rng(seed)
    cone, matrices = Cone(count, size), he(rng.normal(size=(count, size, size)))
    rows = rng.normal(size=cone.rows)
    assert np.isclose(rows @ cone.to_rows(matrices), (cone.multipliers(rows) * matrices).sum())
    assert np.allclose(cone.to_matrices(cone.to_rows(matrices)), matrices)
    assert np.isclose(cone.traces(cone.to_rows(matrices)), np.trace(matrices, axis1=1, axis2=2).sum())
    assert np.isclose(cone.least_eigenvalue(cone.to_rows(matrices)), np.linalg.eigvalsh(matrices).min())


@given(st.integers(1, 4), st.integers(0, 1000))
def test_closed_forms_agree_with_lapack(size, seed) -> None:
    rng = np.random.default_rng(seed)
    root, change = rng.normal(size=(2, 3, size, size)), he(rng.normal(size=(2, 3, size, size)))
    positive = root @ np.swapaxes(root, -1, -2) + 0.1 * np.eye(size)
    triangle = Triangle(size)
    assert np.allclose(inverse(positive) @ positive, np.eye(size), atol=1e-8)
    assert np.allclose(least_eigenvalue(positive), np.linalg.eigvalsh(positive)[..., 0], atol=1e-9)
    assert np.allclose(triangle.unpack(triangle.pack(change)), change)
    bent = triangle.congruence(positive) @ triangle.pack(change)[..., None]
    assert np.allclose(triangle.unpack(bent[..., 0]), positive @ change @ positive)
    step = largest_step(positive, change)
    for row in np.flatnonzero(np.isfinite(step)):
        touching = np.linalg.eigvalsh(positive[row] + step[row] * change[row]).min()
        assert abs(touching) < 1e-6 * (1.0 + np.abs(positive[row]).max() + step[row] * np.abs(change[row]).max())


@pytest.mark.parametrize(
    ("A", "sign"), [([[-1.0, 2.0], [0.0, -1.0]], 1), ([[1.0, 2.0], [0.0, 1.0]], -1), ([[1.0, 2.0], [0.0, -1.0]], 0)]
)
def test_margin_has_the_sign_of_feasibility_and_is_zero_where_a_singular_p_would_do(A, sign) -> None:
    margin = MarginSolver().solve(lyapunov(np.array(A))).margin
    assert np.sign(margin) * (abs(margin) > 1e-6) == sign


@pytest.mark.parametrize("factor", [1e-9, 1.0, 1e9])
def test_badly_scaled_states_and_times_do_not_change_the_sign(factor) -> None:
    rng = np.random.default_rng(1)
    A = rng.normal(size=(4, 4))
    A -= (np.linalg.eigvals(A).real.max() + 0.3) * np.eye(4)
    T = np.diag(10.0 ** np.array([-4.0, 0.0, 3.0, 5.0]))
    found = MarginSolver().solve(lyapunov(factor * np.linalg.solve(T, A @ T)))
    assert found.margin > 1e-3
    assert min(found.margins) > 1e-3
    assert equilibrate(lyapunov(factor * np.linalg.solve(T, A @ T)))[1] is not None


def test_multipliers_of_infeasible_problems_annihilate_the_unknowns() -> None:
    families = lyapunov(np.array([[0.5, 40.0], [0.0, 1.0]]))
    found = MarginSolver().solve(families)
    total = sum((Z * f.linear).sum(axis=(1, 2, 3)) for Z, f in zip(found.multipliers, families, strict=True))
    assert np.abs(total).max() < 1e-6 * max(np.abs(Z).max() for Z in found.multipliers)


def test_limits_of_the_solver_are_errors() -> None:
    with pytest.raises(SolverLimitError, match="limit"):
        MarginSolver(SolverSettings(iterations=1)).solve(lyapunov(-np.eye(3)))
    with pytest.raises(ArgumentError, match="time_limit_s"):
        SolverSettings(time_limit_s=0.0)


def test_objectives_without_a_minimum_or_a_solution_are_errors() -> None:
    families = lyapunov(-np.eye(2))
    with pytest.raises(SolverError):
        minimise(families, linear=-np.ones(3))
    with pytest.raises(ArgumentError, match="neither"):
        minimise(families)
    with pytest.raises(ArgumentError, match="shape"):
        minimise(families, linear=np.ones(2))
    with pytest.raises(ArgumentError, match="shape"):
        minimise(families, quadratic=np.ones((2, 2)))


def test_quadratic_costs_reach_the_closest_point() -> None:
    unknowns = Unknowns((Unknown("g", 1),))
    families = coefficients(unknowns, lambda v: (Constraint("g >= 2", v["g"][..., None, :, :] - 2.0),))
    assert minimise(families, quadratic=np.eye(1)).vector[0] == pytest.approx(2.0, abs=1e-6)


def test_margin_needs_homogeneous_families_and_a_size() -> None:
    families = lyapunov(-np.eye(2))
    with pytest.raises(ArgumentError, match="sized"):
        MarginSolver().solve(families[1:])
    unknowns = Unknowns((Unknown("g", 1),))
    affine = coefficients(unknowns, lambda v: (Constraint("g >= 2", v["g"][..., None, :, :] - 2.0, sized=True),))
    with pytest.raises(ArgumentError, match="homogeneous"):
        MarginSolver().solve(affine)


@pytest.mark.parametrize("name", ["clarabel", "scipy"])
def test_a_missing_solver_is_named(name, monkeypatch) -> None:
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(MissingDependencyError, match=f"{name} is not installed"):
        MarginSolver().solve(lyapunov(-np.eye(2)))


def test_coefficients_that_are_not_finite_are_refused() -> None:
    with np.errstate(over="ignore"), pytest.raises(ArgumentError, match="overflow"):
        lyapunov(np.full((2, 2), 1e308) * 10.0)


@pytest.mark.parametrize("size", [1, 2, 3])
def test_batched_margins_agree_with_single_ones(size) -> None:
    rng = np.random.default_rng(size)
    matrices = rng.normal(size=(30, size, size)) - rng.uniform(0.0, 3.0, (30, 1, 1)) * np.eye(size)
    families = [lyapunov(A) for A in matrices]
    single = np.array([MarginSolver().solve(one).margin for one in families])
    stacks = [
        Stack(np.stack([one[k].linear for one in families]), families[0][k].weight, families[0][k].sized)
        for k in range(2)
    ]
    found = best_margins(stacks)
    clear = np.abs(single) > 1e-6
    assert clear.sum() > 10
    assert ((found.lower > 0.0) == (single > 0.0))[clear].all()
    assert ((found.upper < 0.0) == (single < 0.0))[clear].all()
    assert not (found.lower > 0.0)[~clear].any()


def test_block_matrices_broadcast_and_keep_exact_zeros() -> None:
    one = exact_array([[1]])
    built = blocks([[np.broadcast_to(one, (4, 1, 1)), None], [None, one]])
    assert built.shape == (4, 2, 2)
    assert (built[2] == exact_array([[1, 0], [0, 1]])).all()
