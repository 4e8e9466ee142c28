"""What happens when solvers fail: another way is tried, and nothing is decided without a proof."""

import numpy as np
import pytest

import robust_core
from robust_core.analysis import decide, decide_many, largest_decay, maps
from robust_core.analysis.decide import conclude_feasible, conclude_infeasible
from robust_core.errors import ArgumentError, SolverError
from robust_core.lmi.conic import ConicSolution
from robust_core.lmi.margin import MarginSolver
from robust_core.lmi.settings import SolverSettings
from robust_core.models import PolytopicSystem
from robust_core.theorems import CommonLyapunov, DStability
from robust_core.theorems.regions import half_plane
from robust_core.verdict import Verdict

STABLE, UNSTABLE = PolytopicSystem.of([-np.eye(2)]), PolytopicSystem.of([np.eye(2)])
NAMES = ("P > 0", "(2.2.1) < 0")


def solution(vector, multipliers=(), margins=(1.0, 1.0)) -> ConicSolution:
    """What a solver might have returned."""
    return ConicSolution(np.array(vector), 1.0, tuple(multipliers), 1.0, "Solved", 1, margins)


@pytest.fixture
def no_barrier(monkeypatch) -> None:
    """A batch that breaks down."""

    def fail(*_, **__):
        raise np.linalg.LinAlgError("singular")

    monkeypatch.setattr(maps, "best_margins", fail)


def test_a_batch_that_breaks_down_is_asked_one_by_one(no_barrier) -> None:
    verdicts = [result.verdict for result in decide_many(CommonLyapunov(), [STABLE, UNSTABLE])]
    assert verdicts == [Verdict.PROVEN, Verdict.INFEASIBLE]


def test_points_where_every_solver_fails_are_undecided_with_the_reason(no_barrier, monkeypatch) -> None:
    def fail(*_, **__):
        raise SolverError("no luck")

    monkeypatch.setattr(MarginSolver, "ask", fail)
    (result,) = decide_many(CommonLyapunov(), [STABLE])
    assert result.verdict is Verdict.UNDECIDED
    assert "no luck" in result.reason
    with pytest.raises(SolverError):
        decide(CommonLyapunov(), STABLE)


@pytest.mark.parametrize("exact", [True, False])
def test_a_solution_that_is_none_is_not_believed(exact) -> None:
    wrong = solution([1.0, 2.0, 1.0], margins=(-1.0, 1.0))
    result = conclude_feasible(CommonLyapunov(), STABLE, wrong, NAMES, exact=exact)
    assert result.verdict is Verdict.UNDECIDED
    assert result.certificate is None


@pytest.mark.parametrize("Z", [np.zeros((1, 2, 2)), np.full((1, 2, 2), np.nan), -np.eye(2)[None], np.eye(2)[None]])
def test_multipliers_that_rule_out_nothing_are_not_believed(Z) -> None:
    result = conclude_infeasible(CommonLyapunov(), STABLE, solution([1.0, 0.0, 1.0], (Z, Z)), exact=True)
    assert result.verdict is Verdict.UNDECIDED


def test_a_template_says_the_same_as_the_formulas_and_steps_aside_for_bad_scaling() -> None:
    kept, scaled = MarginSolver(), PolytopicSystem.of([[[-1.0, 1e9], [0.0, -1.0]]])
    for model in (STABLE, STABLE, STABLE, UNSTABLE, scaled):
        assert decide(CommonLyapunov(), model, solver=kept).verdict is decide(CommonLyapunov(), model).verdict
    assert decide(CommonLyapunov(), scaled, solver=kept).verdict is Verdict.PROVEN


def test_settings_reach_the_solver() -> None:
    with pytest.raises(SolverError, match="limit"):
        decide(CommonLyapunov(), STABLE, solver=MarginSolver(SolverSettings(iterations=1)))


def test_decay_is_a_question_to_stability_theorems_only() -> None:
    with pytest.raises(ArgumentError, match="one on stability"):
        largest_decay(DStability.within(half_plane(0.0)), STABLE)


def test_the_package_offers_its_names_and_no_others() -> None:
    assert robust_core.decide is decide
    assert "PolytopicSystem" in dir(robust_core)
    assert all(getattr(robust_core, name) is not None for name in robust_core.__all__)
    with pytest.raises(AttributeError, match="nonsense"):
        _ = robust_core.nonsense
