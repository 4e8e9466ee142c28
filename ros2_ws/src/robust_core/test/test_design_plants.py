"""The example plants of the designs: models against the equations they stand for."""

import math
import subprocess
import sys

import numpy as np
import pytest

from robust_core.analysis import decide
from robust_core.errors import ArgumentError
from robust_core.plants import chua, tunnel_diode
from robust_core.plants.following_loop import following_loop, printed_loop
from robust_core.theorems import CommonLyapunov
from robust_core.verdict import Verdict

RNG = np.random.default_rng(0)


def test_chua_vertices_mix_to_the_circuit() -> None:
    model = chua.stabilisation()
    states = RNG.uniform(-6.0, 6.0, (200, 3))
    mixed = np.einsum("kr,rij,kj->ki", chua.stabilisation_weights(states[:, 1]), model.A, states)
    assert mixed == pytest.approx(chua.derivative(states), abs=1e-10)


def test_chua_errors_mix_to_the_difference_of_two_circuits() -> None:
    model = chua.synchronisation()
    x, y = RNG.uniform(-6.0, 6.0, (2, 200, 3))
    weights = chua.synchronisation_weights(x[:, 1], y[:, 1])
    mixed = np.einsum("kr,rij,kj->ki", weights, model.A, y - x)
    assert mixed == pytest.approx(chua.derivative(y) - chua.derivative(x), abs=1e-9)
    assert (weights >= -1e-12).all()
    assert weights[:, :2].sum(axis=1) == pytest.approx(0.5)


def test_chua_rates_are_bounds_over_the_box_and_the_printed_last_one_is_not() -> None:
    x1, x2 = np.meshgrid(np.linspace(-6.0, 6.0, 601), np.linspace(-6.0, 6.0, 601))
    x2_rate = chua.derivative(np.stack([x1, x2, 0.0 * x1], axis=-1))[..., 1]
    rates = [x2_rate / 24.0, -x2_rate / 24.0, -x2 * x2_rate / 36.0, x2 * x2_rate / 36.0]
    peaks = [float(rate.max()) for rate in rates]
    assert all(peak <= bound + 1e-12 for peak, bound in zip(peaks, chua.PHI, strict=True))
    assert peaks == pytest.approx(chua.PHI, rel=1e-4)
    assert peaks[3] > chua.PRINTED_PHI4 + 0.03


def test_currents_are_limited_and_follow_the_weights() -> None:
    gains = RNG.normal(size=(4, 1, 3))
    state = np.array([1.0, 2.0, -3.0])
    free = chua.stabilising_current(gains)(state)
    assert free == pytest.approx(chua.stabilisation_weights(2.0) @ gains[:, 0] @ state)
    assert abs(chua.stabilising_current(100.0 * gains, limit=10.0)(state)) == 10.0
    pair = np.concatenate([state, state])
    assert chua.synchronising_current(gains)(pair) == pytest.approx(0.0)
    with pytest.raises(ArgumentError):
        chua.stabilising_current(gains, limit=0.0)


def test_tunnel_diode_vertices_mix_to_the_circuit_of_one_henry() -> None:
    plant = tunnel_diode.tunnel_diode()
    for _ in range(50):
        x, w = RNG.uniform([-3.0, -1.0], [3.0, 1.0]), RNG.uniform(-1.0, 1.0)
        resistance = RNG.uniform(*tunnel_diode.RESISTANCE_OHM)
        square, alpha = x[0] ** 2 / 18.0, resistance - 10.0
        weights = np.array([square, 0.5 - square, (3.0 + alpha) / 12.0, (3.0 - alpha) / 12.0])
        mixed = np.tensordot(weights, plant.floats["A"], axes=1) @ x + plant.floats["B"][0] @ [w]
        assert mixed == pytest.approx(tunnel_diode.derivative(x, w, resistance), abs=1e-9)


def test_following_loop_is_proven_within_the_field_of_view_only() -> None:
    regional = following_loop(0.8, 2.0, 0.6)
    rate = 0.8 * math.cos(0.6) ** 2
    assert decide(CommonLyapunov(decay=0.999 * rate), regional).verdict is Verdict.PROVEN
    assert decide(CommonLyapunov(decay=1.001 * rate), regional).verdict is not Verdict.PROVEN
    assert decide(CommonLyapunov(), printed_loop(0.8, 2.0)).verdict is not Verdict.PROVEN


@pytest.mark.parametrize("arguments", [(0.0, 1.0, 0.5), (1.0, -1.0, 0.5), (1.0, 1.0, 1.6), (1.0, 1.0, float("nan"))])
def test_following_loop_refuses_what_has_no_certificate(arguments: tuple[float, float, float]) -> None:
    with pytest.raises(ArgumentError):
        following_loop(*arguments)


@pytest.mark.parametrize(
    "module", ["chua", "tunnel_diode", "following_loop", "tracking_error", "vibration_sensor", "x_structure"]
)
def test_plants_import_no_solver(module: str) -> None:
    code = (
        f"import sys, robust_core.plants.{module}\n"
        "heavy = {'clarabel', 'scipy', 'cvxpy', 'casadi'} & set(sys.modules)\n"
        "sys.exit(str(heavy) if heavy else 0)"
    )
    subprocess.run([sys.executable, "-c", code], check=True, env={"PYTHONPATH": ":".join(sys.path)})
