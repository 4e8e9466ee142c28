"""Stabilising designs: what they prove, what they refuse, and that nothing is claimed that simulation contradicts."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robust_core.analysis import decide
from robust_core.analysis.decay import largest_decay
from robust_core.certificates import load_certificate, save_certificate
from robust_core.errors import (
    ArgumentError,
    CertificateDamagedError,
    CertificateMismatchError,
    NotProvenError,
    ProofFailedError,
    RateError,
    SolverError,
)
from robust_core.models import PolytopicSystem
from robust_core.plants import chua
from robust_core.stabilisation import ClosedLoop, Request, design_dependent, design_quadratic
from robust_core.stabilisation.closed_loop import gains_as_floats
from robust_core.theorems import CommonLyapunov
from robust_core.theorems.regions import disc, half_plane
from robust_core.verdict import Verdict

DOUBLE_INTEGRATORS = PolytopicSystem.of([[[0, 1], [0, 0]], [[0, 1], [2, 0]]], [[0], [1]])
UNEQUAL_INPUTS = PolytopicSystem.of(
    [[[0.0, 1.0], [1.0, -1.0]], [[0.0, 1.0], [-1.0, 0.5]]], [[[0.0], [1.0]], [[0.0], [2.0]]]
)


def closed_loop_at(model: PolytopicSystem, gains: Any, weights: Any) -> Any:
    assert model.B is not None
    A, B, K = (np.tensordot(weights, part, axes=1) for part in (model.A, model.B, gains))
    return A + B @ K


@pytest.mark.parametrize(
    ("model", "gains", "decay"),
    [
        (chua.stabilisation(), chua.PRINTED_STABILISATION_GAINS, "0.376"),
        (chua.synchronisation(), chua.PRINTED_SYNCHRONISATION_GAINS, "0.1536"),
    ],
    ids=["stabilisation", "synchronisation"],
)
def test_printed_gains_are_certified_with_the_decay_of_the_errata_and_no_more(
    model: Any, gains: Any, decay: Any
) -> None:
    assert decide(ClosedLoop.of(gains, decay=decay), model).verdict is Verdict.PROVEN
    assert decide(ClosedLoop.of(gains, decay=float(decay) + 0.001), model).verdict is Verdict.INFEASIBLE


def test_a_closed_loop_and_its_model_of_their_own_agree_on_the_largest_decay() -> None:
    loop = chua.stabilisation().closed_loop(np.array(chua.PRINTED_STABILISATION_GAINS, dtype=object))
    decay, result = largest_decay(CommonLyapunov(), loop)
    assert decay == pytest.approx(0.3763, abs=2e-4)
    assert result.verdict is Verdict.PROVEN


def test_design_without_limits_is_small_and_proven() -> None:
    design = design_quadratic(chua.synchronisation())
    assert design.name == "Q"
    assert design.result.verdict is Verdict.PROVEN
    assert np.abs(design.K).max() < 10.0
    claim = design.result.require().theorem
    assert isinstance(claim, ClosedLoop)
    assert gains_as_floats(claim) == pytest.approx(design.K, abs=0.0)


def test_design_with_limits_keeps_them_everywhere_in_its_ellipsoid() -> None:
    starts = np.array([[1.5, 1.0, 4.0], [-1.5, -1.0, -4.0]])
    request = Request(decay=0.2, input_limit=10.0, box={1: 6.0}, start=starts, objective="small set")
    design = design_quadratic(chua.stabilisation(), request)
    assert design.name == "S"
    assert design.result.verdict is Verdict.PROVEN
    P = design.ellipsoid()
    inverse = np.linalg.inv(P)
    assert np.einsum("ki,ij,kj->k", starts, P, starts).max() <= 1.0
    assert np.einsum("mri,ij,mrj->mr", design.K, inverse, design.K).max() <= 100.0
    assert inverse[1, 1] <= 36.0


def test_large_set_is_larger_than_the_small_one() -> None:
    request: dict[str, Any] = {"decay": 0.2, "input_limit": 10.0, "box": {1: 6.0}, "start": [[1.0, 0.5, 2.0]]}
    small, large = (
        design_quadratic(chua.stabilisation(), Request(**request, objective=objective))
        for objective in ("small set", "large set")
    )
    assert large.result.verdict is small.result.verdict is Verdict.PROVEN
    assert np.linalg.det(large.ellipsoid()) < np.linalg.det(small.ellipsoid())


def test_constraints_combine() -> None:
    request = Request(
        decay=0.5, region=disc(-5.0, 4.9), input_limit=[40.0], box=[[1.0, 0.0]], box_limit=[2.0], start=[[0.5, 0.0]]
    )
    design = design_quadratic(DOUBLE_INTEGRATORS, request)
    assert design.result.verdict is Verdict.PROVEN
    for weight in (0.0, 0.3, 1.0):
        poles = np.linalg.eigvals(closed_loop_at(DOUBLE_INTEGRATORS, design.K, np.array([weight, 1.0 - weight])))
        assert np.abs(poles + 5.0).max() < 4.9
        assert poles.real.max() < -0.5


def test_different_input_matrices_are_designed_on_pairs() -> None:
    design = design_quadratic(UNEQUAL_INPUTS, Request(decay=0.3))
    assert design.result.verdict is Verdict.PROVEN
    for weight in np.linspace(0.0, 1.0, 11):
        loop = closed_loop_at(UNEQUAL_INPUTS, design.K, np.array([weight, 1.0 - weight]))
        assert np.linalg.eigvals(loop).real.max() < -0.3


def test_inputs_that_change_sign_are_never_proven() -> None:
    opposite = PolytopicSystem.of([[[1.0]], [[1.0]]], [[[1.0]], [[-1.0]]])
    with pytest.raises(SolverError):
        design_quadratic(opposite)
    for gain in (1.0, 10.0, 100.0):
        result = decide(ClosedLoop.of([[[-gain]], [[gain]]]), opposite)
        assert result.verdict not in (Verdict.PROVEN, Verdict.SUPPORTED)


@settings(max_examples=25, deadline=None, derandomize=True)
@given(seed=st.integers(0, 10_000))
def test_a_proven_design_never_meets_an_unstable_mixture(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n, m, r = int(rng.integers(1, 4)), int(rng.integers(1, 4)), int(rng.integers(1, 3))
    model = PolytopicSystem.of(rng.normal(size=(m, n, n)), rng.normal(size=(m, n, r)))
    try:
        design = design_quadratic(model, Request(decay=0.1))
    except SolverError:
        return
    if design.result.verdict is Verdict.PROVEN:
        for weights in rng.dirichlet(np.ones(m), size=20):
            assert np.linalg.eigvals(closed_loop_at(model, design.K, weights)).real.max() < -0.1 + 1e-9


@pytest.mark.parametrize(
    "problem", [chua.stabilisation, chua.synchronisation], ids=["stabilisation", "synchronisation"]
)
def test_parameter_dependent_design_is_proven_by_theorem_2_3(problem: Any) -> None:
    design = design_dependent(problem(), rates_hold_in_closed_loop=True, mu=(1e-3, 1e-2))
    assert design.result.verdict is Verdict.PROVEN
    assert design.result.require().theorem.NAME == "2.3"


def test_parameter_dependent_design_with_a_bound_has_smaller_gains() -> None:
    free = design_dependent(chua.synchronisation(), rates_hold_in_closed_loop=True, mu=(1e-3,))
    bound = design_dependent(chua.synchronisation(), rates_hold_in_closed_loop=True, mu=(1e-3,), gain_bound=30.0)
    assert np.abs(bound.K).max() < np.abs(free.K).max()


def test_parameter_dependent_design_refuses_circular_rates() -> None:
    with pytest.raises(RateError, match="closed loop"):
        design_dependent(chua.stabilisation(), rates_hold_in_closed_loop=False)
    with pytest.raises(RateError):
        design_dependent(chua.stabilisation(rates=None), rates_hold_in_closed_loop=True)


def test_parameter_dependent_design_refuses_what_it_cannot_do() -> None:
    with pytest.raises(ArgumentError, match="B must"):
        design_dependent(
            PolytopicSystem.of(UNEQUAL_INPUTS.A, UNEQUAL_INPUTS.B, rates=[1.0, 1.0]), rates_hold_in_closed_loop=True
        )
    with pytest.raises(ArgumentError, match="model"):
        design_dependent(PolytopicSystem.of([[[-1.0]]], rates=[0.0]), rates_hold_in_closed_loop=True)
    with pytest.raises(ArgumentError, match="z must"):
        design_dependent(chua.stabilisation(), rates_hold_in_closed_loop=True, z=9)


def test_parameter_dependent_design_that_fails_says_so_and_claims_nothing() -> None:
    uncontrollable = PolytopicSystem.of([[[1.0, 0.0], [0.0, -1.0]]], [[0.0], [1.0]], rates=[0.0])
    design = design_dependent(uncontrollable, rates_hold_in_closed_loop=True, mu=(1e-2,))
    assert design.result.verdict is Verdict.UNDECIDED
    assert not design.K.any()
    with pytest.raises(NotProvenError):
        design.ellipsoid()


def test_uncontrollable_unstable_plants_give_an_error_not_a_claim() -> None:
    with pytest.raises(SolverError):
        design_quadratic(PolytopicSystem.of([[[1.0, 0.0], [0.0, -1.0]]], [[0.0], [1.0]]))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"decay": -1.0}, "decay"),
        ({"reserve": 0.9}, "reserve"),
        ({"objective": "cheap"}, "objective"),
        ({"objective": "large set"}, "objective"),
        ({"objective": "small set"}, "objective"),
        ({"digits": 1}, "digits"),
    ],
)
def test_requests_that_make_no_sense_are_refused(options: Any, message: Any) -> None:
    with pytest.raises(ArgumentError, match=message):
        Request(**options)


@pytest.mark.parametrize(
    "limits",
    [
        {"input_limit": [1.0, 2.0]},
        {"input_limit": -1.0},
        {"box": {5: 1.0}},
        {"box": {}},
        {"box": {0: np.nan}},
        {"box": [[1.0, 0.0]], "box_limit": [1.0, 2.0]},
        {"start": [[1.0, 2.0, 3.0]]},
        {"start": [[np.inf, 0.0]]},
    ],
)
def test_limits_that_do_not_fit_are_refused(limits: Any) -> None:
    with pytest.raises(ArgumentError):
        design_quadratic(DOUBLE_INTEGRATORS, Request(**limits))


def test_models_without_inputs_are_refused() -> None:
    model = PolytopicSystem.of([[[-1.0]]])
    with pytest.raises(ArgumentError, match="inputs"):
        design_quadratic(model)
    with pytest.raises(ArgumentError, match="inputs"):
        decide(ClosedLoop.of([[[1.0]]]), model)


@pytest.mark.parametrize(
    "options",
    [
        {"gains": [[[1.0, 1.0]]]},
        {"gains": [[[1.0, 1.0]], [[1.0, 1.0]]], "input_limit": [1.0, 1.0]},
        {"gains": [[[1.0, 1.0]], [[1.0, 1.0]]], "start": [[1.0]]},
    ],
)
def test_claims_that_do_not_fit_the_model_are_refused(options: Any) -> None:
    with pytest.raises(ArgumentError):
        decide(ClosedLoop.of(**options), DOUBLE_INTEGRATORS)


def test_claims_with_impossible_limits_are_refused() -> None:
    with pytest.raises(ArgumentError, match="input_limit"):
        ClosedLoop.of([[[1.0]]], input_limit=[0.0])
    with pytest.raises(ArgumentError, match="box_limit"):
        ClosedLoop.of([[[1.0]]], box=[[1.0]], box_limit=[1.0, 1.0])


def test_certificate_of_a_design_survives_a_file_and_no_change(tmp_path: Path) -> None:
    request = Request(decay=0.2, region=half_plane(-0.1), input_limit=20.0, start=[[0.1, 0.1]])
    design = design_quadratic(DOUBLE_INTEGRATORS, request)
    path = save_certificate(design.result.require(), tmp_path / "design.json")
    assert load_certificate(path, model=DOUBLE_INTEGRATORS).claim.startswith("theorem closed loop")
    with pytest.raises(CertificateMismatchError):
        load_certificate(path, model=UNEQUAL_INPUTS)
    content = json.loads(path.read_text())
    content["theorem"]["options"]["gains"][0][0][0] = "0"
    path.write_text(json.dumps(content))
    with pytest.raises(CertificateDamagedError):
        load_certificate(path)


def test_gains_of_another_sign_break_the_proof() -> None:
    design = design_quadratic(DOUBLE_INTEGRATORS, Request(decay=0.2))
    certificate = design.result.require()
    other = type(certificate)(ClosedLoop.of(-design.K, decay=0.2), DOUBLE_INTEGRATORS, certificate.values)
    with pytest.raises(ProofFailedError, match="decay"):
        other.verify()
