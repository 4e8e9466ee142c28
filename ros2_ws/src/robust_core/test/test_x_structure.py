"""The exact X-structure law against the figures and limits that independent derivations give."""

import math
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robust_core.plants.x_structure import STANDARD_GRAVITY_MPS2, SnapThroughError, XStructure

THESIS = XStructure(layers=3, rod_length_m=0.05, angle_rad=math.radians(50.0), spring_npm=5000.0)


def structures() -> st.SearchStrategy[XStructure]:
    return st.builds(
        XStructure,
        layers=st.integers(1, 6),
        rod_length_m=st.floats(0.02, 0.2),
        angle_rad=st.floats(0.3, 1.3),
        spring_npm=st.floats(100.0, 20_000.0),
        joint_damping_nms=st.floats(0.0, 0.1),
    )


def test_frequency_without_gravity_is_the_printed_formula() -> None:
    printed = math.tan(THESIS.angle_rad) / (2.0 * math.pi * THESIS.layers) * math.sqrt(THESIS.spring_npm / 0.5)
    assert THESIS.natural_frequency_hz(0.5, gravity=False) == pytest.approx(printed, rel=1e-12)
    assert printed == pytest.approx(6.32, abs=0.005)


@pytest.mark.parametrize(
    ("mass_kg", "frequency_hz"), [(0.5, 5.67), (1.0, 3.50), (1.5, 2.35), (2.0, 1.35), (2.15, 0.84)]
)
def test_frequency_under_gravity(mass_kg: float, frequency_hz: float) -> None:
    assert THESIS.natural_frequency_hz(mass_kg) == pytest.approx(frequency_hz, abs=0.006)


def test_quasi_zero_stiffness_point() -> None:
    assert THESIS.peak_load_n == pytest.approx(21.49, abs=0.01)
    assert THESIS.peak_travel_m == pytest.approx(-0.0783, abs=1e-4)
    assert THESIS.stiffness_npm(THESIS.peak_travel_m) == pytest.approx(0.0, abs=1e-6)


def test_travel_is_asymmetric() -> None:
    assert THESIS.travel_limits_m == pytest.approx((-0.230, 0.070), abs=5e-4)


@pytest.mark.parametrize("load_n", [21.5, 30.0, math.inf])
def test_a_load_beyond_the_peak_is_refused_with_the_limit(load_n: float) -> None:
    with pytest.raises(SnapThroughError, match=r"snaps .* less than 21\.49 N"):
        THESIS.equilibrium_m(load_n)


@pytest.mark.parametrize("load_n", [-1.0, math.nan])
def test_a_load_that_is_no_weight_is_refused(load_n: float) -> None:
    with pytest.raises(ValueError, match="load_n"):
        THESIS.equilibrium_m(load_n)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("layers", 0),
        ("layers", 2.5),
        ("rod_length_m", 0.0),
        ("spring_npm", math.nan),
        ("angle_rad", 0.0),
        ("angle_rad", 1.6),
        ("preload_m", 0.1),
    ],
)
def test_impossible_parameters_name_the_offender(field: str, value: float) -> None:
    arguments = {"layers": 3, "rod_length_m": 0.05, "angle_rad": 0.9, "spring_npm": 5000.0, field: value}
    with pytest.raises(ValueError, match=field):
        XStructure(**arguments)  # type: ignore[arg-type]


@given(structures(), st.floats(0.0, 0.999))
def test_equilibrium_carries_the_load_stably(structure: XStructure, fraction: float) -> None:
    load = fraction * structure.peak_load_n
    travel = structure.equilibrium_m(load)
    assert structure.force_n(travel) == pytest.approx(load, rel=1e-9, abs=1e-9 * structure.peak_load_n)
    assert structure.stiffness_npm(travel) > 0.0


@given(structures(), st.floats(0.02, 0.98))
def test_stiffness_is_the_slope_of_the_force(structure: XStructure, fraction: float) -> None:
    low, high = structure.travel_limits_m
    travel, step = low + fraction * (high - low), 1e-6 * (high - low)
    slope = (structure.force_n(travel + step) - structure.force_n(travel - step)) / (2.0 * step)
    scale = structure.spring_npm / structure.layers**2
    assert structure.stiffness_npm(travel) == pytest.approx(-slope, rel=1e-5, abs=1e-5 * scale)


def test_preload_moves_the_loaded_angle_to_the_assembly_angle() -> None:
    load = 0.5 * STANDARD_GRAVITY_MPS2
    preload = -load * THESIS.layers / (THESIS.spring_npm * math.tan(THESIS.angle_rad))
    preloaded = XStructure(3, 0.05, THESIS.angle_rad, 5000.0, preload_m=preload)
    assert preloaded.equilibrium_m(load) == pytest.approx(0.0, abs=1e-12)
    assert preloaded.natural_frequency_hz(0.5) == pytest.approx(6.11, abs=0.005)


def test_damping_counts_every_joint() -> None:
    damped = XStructure(3, 0.05, THESIS.angle_rad, 5000.0, joint_damping_nms=0.01)
    assert damped.joint_count == 10
    assert damped.damping_nspm(0.0) == pytest.approx(0.1 / (3.0 * damped.rest_width_m) ** 2)


def test_sensor_of_table_4_3_cannot_carry_its_own_mass() -> None:
    sensor = XStructure(3, 0.10, 0.13 * math.pi, 390.0)
    assert sensor.peak_load_n == pytest.approx(0.341, abs=0.001)
    with pytest.raises(SnapThroughError):
        sensor.natural_frequency_hz(0.21)


def test_plants_import_neither_numpy_nor_a_solver() -> None:
    code = (
        "import sys, robust_core.plants.x_structure as x;"
        "print([m for m in ('numpy', 'scipy', 'cvxpy', 'rclpy') if m in sys.modules], x.__name__)"
    )
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env={"PYTHONPATH": ":".join(sys.path)}
    )
    assert result.stdout.startswith("[] ")
