"""Filters for a band of frequencies: proofs against grids, and what no filter can do."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robust_core.analysis import decide
from robust_core.certificates import load_certificate, save_certificate
from robust_core.errors import ArgumentError, SolverError
from robust_core.filtering import (
    Filter,
    FiniteFrequencyDesign,
    FiniteFrequencyFilter,
    band_gain,
    certify_band,
    design_filter,
    design_finite_frequency,
    error_gain,
    h_infinity,
    limit_of_filters,
)
from robust_core.filtering.complex_form import hermitian
from robust_core.models import FilterPlant
from robust_core.plants.tunnel_diode import PRINTED_FILTER, tunnel_diode
from robust_core.theorems.regions import disc
from robust_core.verdict import Verdict

DISC = disc(-20.0, 19.9)
PLANT = tunnel_diode().attained()
THESIS_FILTER = Filter.of(**PRINTED_FILTER)
SLOW_BAND = (1.6 * np.pi, 2.4 * np.pi)
FAST_BAND = (48.0 * np.pi, 72.0 * np.pi)


@pytest.fixture(scope="module")
def slow_design() -> FiniteFrequencyDesign:
    return design_finite_frequency(PLANT, SLOW_BAND, region=DISC, ratios=(1.0,))


def test_design_is_proven_and_near_what_no_filter_can_beat(slow_design: FiniteFrequencyDesign) -> None:
    assert slow_design.result.verdict is Verdict.PROVEN
    limit = max(limit_of_filters(PLANT, w) for w in np.linspace(*SLOW_BAND, 9))
    assert limit == pytest.approx(0.02607, abs=1e-5)
    assert limit < slow_design.gamma < 1.02 * limit


def test_design_beats_the_full_band_filter_in_its_band(slow_design: FiniteFrequencyDesign) -> None:
    full = design_filter(PLANT, h_infinity(), region=DISC, certify=False).filtering
    assert slow_design.gamma < 0.9 * band_gain(PLANT, full, SLOW_BAND)


def test_frozen_mixtures_keep_the_proven_gain(slow_design: FiniteFrequencyDesign) -> None:
    rng = np.random.default_rng(0)
    for weights in rng.dirichlet(np.ones(PLANT.count), size=30):
        mixed = {name: np.tensordot(weights, PLANT.floats[name], axes=1)[None] for name in "ABCDEF"}
        plant = FilterPlant.of(**mixed)
        assert error_gain(plant, slow_design.filtering, np.linspace(*SLOW_BAND, 41)).max() <= slow_design.gamma


def test_frozen_poles_are_in_the_region(slow_design: FiniteFrequencyDesign, tmp_path: Path) -> None:
    certificate = slow_design.result.require()
    A = certificate.theorem.data(PLANT)["error"][0]
    assert all(DISC.contains(np.linalg.eigvals(matrix)).all() for matrix in A)
    path = save_certificate(certificate, tmp_path / "band.json")
    assert load_certificate(path, model=PLANT).theorem == certificate.theorem


def test_fast_band_is_far_below_the_full_band_filter() -> None:
    design = design_finite_frequency(PLANT, FAST_BAND, region=DISC, ratios=(0.2,))
    assert design.result.verdict is Verdict.PROVEN
    assert design.gamma < 5e-4


def test_printed_filter_is_certified_in_the_band_and_not_below_its_gain() -> None:
    found = certify_band(PLANT, THESIS_FILTER, SLOW_BAND)
    assert found.result.verdict is Verdict.PROVEN
    assert found.grid_gamma <= found.gamma <= 1.01 * found.grid_gamma
    below = FiniteFrequencyFilter(THESIS_FILTER, *SLOW_BAND, 0.99 * found.grid_gamma)
    assert decide(below, PLANT).verdict is not Verdict.PROVEN


def test_certificate_of_an_unstable_filter_does_not_exist() -> None:
    found = certify_band(PLANT, Filter.of([[1.0]], [[0.1]], [[0.1]]), SLOW_BAND)
    assert found.result.verdict is not Verdict.PROVEN
    assert np.isnan(found.gamma)


@pytest.mark.parametrize("band", [(2.0, 1.0), (1.0, 1.0), (-1.0, 1.0), (np.nan, 1.0), (0.0, np.inf)])
def test_empty_and_malformed_bands_are_refused(band: Any) -> None:
    with pytest.raises(ArgumentError):
        design_finite_frequency(PLANT, band)


@pytest.mark.parametrize("options", [(2, 1, 1), (-1, 1, 1), (0, 1, 0)])
def test_malformed_claims_are_refused(options: Any) -> None:
    with pytest.raises(ArgumentError):
        FiniteFrequencyFilter(THESIS_FILTER, *options)


def test_signals_that_the_disturbance_does_not_move_are_refused() -> None:
    plant = FilterPlant.of(A=[[[-1.0]]], B=[[0.0]], C=[[1.0]], E=[[1.0]])
    with pytest.raises(ArgumentError, match="moves"):
        design_finite_frequency(plant, (1.0, 2.0))


def test_a_design_without_any_solution_names_the_tries() -> None:
    with pytest.raises(SolverError, match="no filter"):
        design_finite_frequency(PLANT, SLOW_BAND, region=DISC, ratios=())
    with pytest.raises(ArgumentError, match="widen"):
        design_finite_frequency(PLANT, SLOW_BAND, region=disc(-20.0, 5.0))


def test_limit_is_below_every_filter_of_random_ones() -> None:
    rng = np.random.default_rng(1)
    limit = limit_of_filters(PLANT, 6.0)
    for _ in range(50):
        filtering = Filter.of(
            rng.normal(size=(2, 2)) - 5.0 * np.eye(2), rng.normal(size=(2, 1)), rng.normal(size=(1, 2))
        )
        assert error_gain(PLANT, filtering, np.array([6.0])).max() >= limit


def test_free_numbers_make_hermitian_matrices() -> None:
    free = np.random.default_rng(0).normal(size=(5, 3, 3))
    form = hermitian(free)
    matrix = form.real + 1j * form.imaginary
    assert np.array_equal(matrix, np.conj(np.swapaxes(matrix, -1, -2)))
    doubled = np.sort(np.linalg.eigvalsh(form.embedded()), axis=-1)[:, ::2]
    assert doubled == pytest.approx(np.linalg.eigvalsh(matrix))
