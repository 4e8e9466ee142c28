"""Lipschitz observers: suprema of the errata, proofs, and residuals that see faults."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robust_core.analysis import decide
from robust_core.certificates import load_certificate, save_certificate
from robust_core.errors import ArgumentError
from robust_core.models.lipschitz_plant import LipschitzPlant
from robust_core.observers import (
    BlindObserverError,
    FaultObserver,
    LipschitzObserver,
    admissible_pole,
    design_observer,
    largest_tau,
    supremum_tau,
)
from robust_core.observers.theorem_4_1 import tau_of, units_option
from robust_core.plants.vibration_sensor import VibrationSensor
from robust_core.verdict import Verdict

SENSOR = VibrationSensor()
PLANT = SENSOR.plant()


@pytest.mark.parametrize("mass_kg", [0.18, 0.25])
@pytest.mark.parametrize("spring_npm", [380.0, 400.0])
def test_supremum_is_one_over_the_period_whatever_mass_and_stiffness(mass_kg: float, spring_npm: float) -> None:
    plant = VibrationSensor(mass_kg=mass_kg, spring_npm=spring_npm).plant()
    assert supremum_tau(plant) == pytest.approx(1000.0, abs=1e-3)


def test_baselines_are_those_of_the_errata() -> None:
    assert supremum_tau(PLANT, young=1.0) == pytest.approx(707.107, abs=1e-2)
    assert supremum_tau(PLANT, young=0.1) == pytest.approx(301.511, abs=1e-2)
    assert supremum_tau(PLANT, luenberger=True) == pytest.approx(627.16, abs=0.1)


@pytest.mark.parametrize("tau", [0.0, 80.0, 703.5384, 990.0])
def test_closed_form_is_proven_and_as_slow_as_it_may_be(tau: float) -> None:
    design = design_observer(PLANT, tau)
    assert design.result.verdict is Verdict.PROVEN
    assert design.pole == pytest.approx(1.0 - tau / 1000.0, abs=2e-3)
    if tau > 0.0:
        assert tau < largest_tau(PLANT, design.observer) < tau * 1.01


def test_closed_form_sees_faults_more_the_slower_its_pole() -> None:
    slow, fast = (design_observer(PLANT, 80.0, pole=pole).observer for pole in (0.9, 0.2))
    assert slow.fault_gain(PLANT, 1e-3) > 3.0 * fast.fault_gain(PLANT, 1e-3)
    assert slow.fault_gain(PLANT, np.array([1e-6])) == pytest.approx(1e-6 / (1.0 - 0.9), rel=1e-3)


@settings(max_examples=30, deadline=None, derandomize=True)
@given(tau=st.floats(0.0, 990.0), rho=st.floats(0.01, 1.0))
def test_designed_observers_are_never_blind(tau: float, rho: float) -> None:
    design = design_observer(PLANT, tau, rho=rho)
    assert not design.observer.is_blind(PLANT)
    assert np.abs(np.linalg.eigvals(design.observer.matrices(PLANT)["N"])).max() < 1.0


@pytest.mark.parametrize("tau", [0.0, 1.5e-99, 1e-300, 5e-324, 1e-6])
def test_constants_that_are_nothing_beside_the_model_are_proven_all_the_same(tau: float) -> None:
    assert design_observer(PLANT, tau, rho=0.5).result.verdict is Verdict.PROVEN


def test_the_maximiser_of_the_corollary_is_refused_as_blind() -> None:
    data = PLANT.exact
    E = np.array([[-1], [-data["A"][1, 1] / data["A"][0, 1]]], dtype=object)
    blind = FaultObserver.of(E, [[0], [0]])
    assert (blind.matrices(PLANT)["M"] @ PLANT.data()["D"]).any()
    with pytest.raises(BlindObserverError, match="rho"):
        decide(LipschitzObserver(blind, "500"), PLANT)


def test_a_constant_beyond_the_observer_is_not_proven() -> None:
    observer = design_observer(PLANT, 80.0).observer
    assert decide(LipschitzObserver(observer, "85"), PLANT).verdict is not Verdict.PROVEN


def test_estimate_converges_on_the_nonlinear_sensor() -> None:
    design = design_observer(PLANT, 80.0)
    found, data = design.observer.matrices(PLANT), PLANT.data()
    (_, k2, k3), (_, c1, c2) = SENSOR.stiffness, SENSOR.damping

    def nonlinear(x: Any) -> Any:
        return np.array([k2 * x[0] ** 2 + k3 * x[0] ** 3 + x[1] * (c1 * x[0] + c2 * x[0] ** 2)])

    x, z = np.array([0.01, 0.0]), np.zeros(2)
    for step in range(3000):
        y, u = data["C"] @ x, np.array([2.0 * np.sin(0.05 * step)])
        estimate = z - found["E"] @ y
        z = found["N"] @ z + found["R"] @ u + found["L"] @ y + found["M"] @ data["Df"] @ nonlinear(estimate)
        x = data["A"] @ x + data["Df"] @ nonlinear(x) + data["B"] @ u
    assert np.abs(x - (z - found["E"] @ (data["C"] @ x))).max() < 1e-9
    assert np.abs(x).max() > 1e-4


def test_units_change_the_form_of_the_bound() -> None:
    observer = design_observer(PLANT, 80.0).observer
    # In units of 1 mm and 1 m/s the same number asks more of the travel.
    tighter = LipschitzObserver(observer, "80", units_option([0.001, 1.0]))
    assert decide(tighter, PLANT).verdict is not Verdict.PROVEN
    looser = LipschitzObserver(observer, "80", units_option([10.0, 10.0]))
    assert decide(looser, PLANT).verdict is Verdict.PROVEN
    with pytest.raises(ArgumentError, match="units"):
        decide(LipschitzObserver(observer, "80", units_option([1.0])), PLANT)
    with pytest.raises(ArgumentError, match="units"):
        LipschitzObserver(observer, "80", units_option([1.0, 0.0]))


def test_printed_constant_covers_22_mm_at_8_hz_only() -> None:
    rate = 2.0 * np.pi * 8.0
    assert SENSOR.lipschitz_constant(0.022, rate * 0.022) < 80.0 < SENSOR.lipschitz_constant(0.0225, rate * 0.0225)
    assert SENSOR.lipschitz_constant(0.1, rate * 0.1) == pytest.approx(529.0, abs=1.0)


def test_certificate_survives_a_file(tmp_path: Path) -> None:
    design = design_observer(PLANT, 80.0)
    path = save_certificate(design.result.require(), tmp_path / "observer.json")
    again = load_certificate(path, model=PLANT)
    assert isinstance(again.theorem, LipschitzObserver)
    assert tau_of(again.theorem) == 80.0


def test_constants_that_no_observer_admits_are_refused() -> None:
    with pytest.raises(ArgumentError, match="supremum"):
        admissible_pole(PLANT, 1000.0)
    with pytest.raises(ArgumentError):
        admissible_pole(PLANT, float("nan"))
    with pytest.raises(ArgumentError, match="tau"):
        LipschitzObserver(design_observer(PLANT, 1.0).observer, "-1")


@pytest.mark.parametrize("options", [{"pole": 1.5}, {"pole": float("nan")}, {"rho": 0.0}, {"rho": 1.5}])
def test_options_out_of_range_are_refused(options: Any) -> None:
    with pytest.raises(ArgumentError):
        design_observer(PLANT, 80.0, **options)


def test_plants_of_another_form_are_refused() -> None:
    other = LipschitzPlant.of(A=[[0.5]], B=[[1.0]], C=[[1.0]], Df=[[1.0]], D=[[1.0]])
    with pytest.raises(ArgumentError, match="plant"):
        design_observer(other, 0.1)
    with pytest.raises(ArgumentError, match="E must"):
        FaultObserver.of([[1.0], [1.0]], [[1.0], [1.0]]).matrices(other)
    with pytest.raises(ArgumentError, match="young"):
        supremum_tau(PLANT, young=0.0)
    with pytest.raises(ArgumentError):
        LipschitzPlant.of(A=[[0.5, 0.0]], B=[[1.0]], C=[[1.0]], Df=[[1.0]], D=[[1.0]])
    with pytest.raises(ArgumentError):
        LipschitzPlant.from_json({"matrices": {}})


def test_sensor_refuses_numbers_that_are_not_positive() -> None:
    with pytest.raises(ArgumentError, match="mass_kg"):
        VibrationSensor(mass_kg=0.0)
    with pytest.raises(ArgumentError, match="travel_m"):
        SENSOR.lipschitz_constant(-1.0, 0.0)
