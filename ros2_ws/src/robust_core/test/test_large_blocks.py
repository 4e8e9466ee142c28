"""The method for large blocks: against the sparse solver, and where it must give way to it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robust_core.errors import SolverError, SolverLimitError
from robust_core.filtering import design_filter, h_infinity
from robust_core.lmi import objective
from robust_core.lmi.coefficients import Family
from robust_core.lmi.large_blocks import minimise_large, pays
from robust_core.lmi.objective import minimise
from robust_core.lmi.row_blocks import RowBlocks
from robust_core.lmi.settings import SolverSettings
from robust_core.plants import tunnel_diode
from robust_core.rational import Floats
from robust_core.theorems.regions import disc
from robust_core.verdict import Verdict

SETTINGS = SolverSettings()
IMPOSSIBLE = Family("x >= 1, x <= -1", -np.eye(2)[None], np.diag([1.0, -1.0])[None, None], 1.0, False)


def family(seed: int, *, unknowns: int = 5, count: int = 3, size: int = 4, share: float = 1.0) -> Family:
    """Random coefficients, of which a share is not zero, and an interior around y = 0."""
    rng = np.random.default_rng(seed)
    linear = rng.normal(size=(unknowns, count, size, size)) * (rng.uniform(size=(unknowns, count, size, size)) < share)
    linear = linear + linear.swapaxes(-1, -2)
    return Family("random", np.tile(np.eye(size), (count, 1, 1)), linear, 1.0, False)


def bounded(seed: int, families: list[Family]) -> Floats:
    """An objective that has a minimum: the multipliers' side of it has an interior."""
    rng = np.random.default_rng(seed)
    total = np.zeros(len(families[0].linear))
    for one in families:
        root = rng.normal(size=one.linear.shape[1:])
        total += np.einsum("ikab,kab->i", one.linear, root @ root.swapaxes(-1, -2) + np.eye(root.shape[-1]))
    return total


@settings(max_examples=40, deadline=None, derandomize=True)
@given(seed=st.integers(0, 10_000))
def test_optimum_is_that_of_the_sparse_solver(seed: int) -> None:
    families = [family(seed), family(seed + 1, count=1, size=6, share=0.3)]
    linear = bounded(seed, families)
    found, other = minimise_large(families, linear, SETTINGS), minimise(families, linear=linear)
    assert found is not None
    assert found.objective == pytest.approx(other.objective, rel=1e-6, abs=1e-6)
    assert min(found.margins) > -1e-6


def test_multipliers_are_positive_and_pay_the_objective() -> None:
    families = [family(3)]
    linear = bounded(3, families)
    found = minimise_large(families, linear, SETTINGS)
    assert found is not None
    X = found.multipliers[0]
    assert np.linalg.eigvalsh(X).min() > 0.0
    assert np.einsum("ikab,kab->i", families[0].linear, X) == pytest.approx(linear, abs=1e-5)


@pytest.mark.parametrize("share", [0.1, 0.5, 1.0])
def test_congruence_by_rows_is_the_congruence(share: float) -> None:
    one = family(7, size=5, share=share)
    blocks = RowBlocks.of(one)
    R = np.random.default_rng(7).normal(size=(blocks.count, 5, 5))
    plain = R.swapaxes(-1, -2) @ one.linear[blocks.used] @ R
    packed = blocks.congruent(R)
    assert packed == pytest.approx(np.array([blocks.pack(matrices) for matrices in plain]))
    assert blocks.unpack(packed[0]) == pytest.approx(plain[0])


def test_unknown_that_occurs_nowhere_is_left_out() -> None:
    one = family(8)
    one.linear[2] = 0.0
    blocks = RowBlocks.of(one)
    assert 2 not in blocks.used
    assert blocks.adjoint(one.constant)[2] == 0.0


def test_infeasible_and_unbounded_problems_give_way() -> None:
    assert minimise_large([IMPOSSIBLE], np.ones(1), SETTINGS) is None
    free = Family("x >= -1", np.eye(2)[None], np.eye(2)[None, None], 1.0, False)
    assert minimise_large([free], -np.ones(1), SETTINGS) is None


def test_sparse_solver_has_the_last_word_on_what_has_no_solution(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(objective, "pays", lambda families: True)
    with pytest.raises(SolverError, match="ended with"):
        minimise([IMPOSSIBLE], linear=np.ones(1))


def test_time_limit_is_kept() -> None:
    families = [family(3)]
    with pytest.raises(SolverLimitError):
        minimise_large(families, bounded(3, families), SolverSettings(time_limit_s=1e-9))


def test_it_is_chosen_for_large_blocks_only() -> None:
    assert not pays([family(1)])
    assert pays([family(1, unknowns=40, count=8, size=30, share=0.1)])


@pytest.mark.parametrize("attained", [False, True])
def test_filter_it_designs_is_proven_with_the_known_figure(monkeypatch: pytest.MonkeyPatch, attained: bool) -> None:
    plant = tunnel_diode.tunnel_diode()
    plant = plant.attained() if attained else plant
    usual = design_filter(plant, h_infinity(), region=disc(-20.0, 19.9))
    monkeypatch.setattr(objective, "pays", lambda families: True)
    design = design_filter(plant, h_infinity(), region=disc(-20.0, 19.9))
    assert design.optimum == pytest.approx(usual.optimum, rel=1e-4)
    assert design.analysis is not None and design.analysis.result.verdict is Verdict.PROVEN
