"""The compiled pieces of the belt-force model against independent statements of the same laws."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim_bridge.belts.geometry import rotation_from_quaternion
from sim_bridge.belts.normal_load import solve_tridiagonal
from sim_bridge.belts.parameters import belt_parameters
from sim_bridge.belts.shear import shear_stress
from sim_bridge.belts.state import new_state
from sim_bridge.belts.suspension_law import unit_law
from sim_bridge.sensors.rotations import rotation_from_roll_pitch_yaw
from tracked_description import load_robot
from tracked_description.suspension import x_structure_of

ROBOT = load_robot()
PARAMETERS = belt_parameters(ROBOT, "qzs")
STRUCTURE = x_structure_of(ROBOT)


@given(st.floats(-0.0899, 0.0049))
def test_compiled_unit_is_the_exact_x_structure_between_its_stops(travel):
    force, stiffness, damping = unit_law(PARAMETERS, travel)
    assert force == pytest.approx(STRUCTURE.force_n(travel), rel=1e-12, abs=1e-12)
    assert stiffness == pytest.approx(STRUCTURE.stiffness_npm(travel), rel=1e-12)
    assert damping == pytest.approx(STRUCTURE.damping_nspm(travel), rel=1e-12)


@given(st.floats(-10.0, 10.0))
def test_unit_stays_finite_and_pushes_back_beyond_its_stops(travel):
    force, stiffness, damping = unit_law(PARAMETERS, travel)
    assert math.isfinite(force) and math.isfinite(stiffness) and damping > 0.0
    if travel < -0.1:
        assert force > STRUCTURE.peak_load_n
    if travel > 0.02:
        assert force < 0.0


@given(st.integers(2, 8), st.integers(0, 2**32 - 1))
def test_tridiagonal_solution_satisfies_its_system(size, seed):
    random = np.random.default_rng(seed)
    beside = random.uniform(-1.0, 1.0, size)
    diagonal = 2.5 + random.uniform(0.0, 1.0, size)
    right = random.uniform(-5.0, 5.0, size)
    matrix = np.diag(diagonal) + np.diag(beside[:-1], 1) + np.diag(beside[:-1], -1)
    solution = right.copy()
    solve_tridiagonal(diagonal.copy(), beside, solution)
    assert matrix @ solution == pytest.approx(right, abs=1e-9)


@given(st.floats(-3.0, 3.0), st.floats(-1.5, 1.5), st.floats(-3.0, 3.0))
def test_rotation_agrees_with_that_of_the_sensors(roll, pitch, yaw):
    expected = rotation_from_roll_pitch_yaw(roll, pitch, yaw)
    half = np.array([roll, pitch, yaw]) / 2.0
    (cr, cp, cy), (sr, sp, sy) = np.cos(half), np.sin(half)
    quaternion = (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )
    rotation = np.zeros((3, 3))
    rotation_from_quaternion(*quaternion, rotation)
    assert rotation == pytest.approx(expected, abs=1e-12)


def sheared(slide, friction, speed=0.0, steps=400, rate=480.0):
    """Stress per newton of load after sliding steadily with every bar loaded alike."""
    state, bars = new_state(5, -0.015), 6
    state.belt_speed[:] = speed
    load, slides = np.full((2, bars), 10.0), np.tile(np.asarray(slide, float), (2, bars, 1))
    frictions, stress, damping = np.tile(np.asarray(friction, float), (2, bars, 1)), np.zeros((2, bars, 2)), np.zeros(2)
    for _ in range(steps):
        shear_stress(PARAMETERS, state, load, slides, frictions, stress, damping, 1.0 / rate)
    return stress, damping


@given(
    st.tuples(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0)),
    st.tuples(st.floats(0.02, 1.5), st.floats(0.02, 1.5)),
    st.floats(-0.75, 0.75),
    st.integers(1, 50),
)
def test_shear_never_exceeds_the_friction_ellipse(slide, friction, speed, steps):
    stress, damping = sheared(slide, friction, speed, steps)
    assert np.hypot(stress[..., 0] / friction[0], stress[..., 1] / friction[1]).max() <= 1.0 + 1e-9
    assert (damping >= 0.0).all()


def test_sliding_sideways_meets_lateral_friction_against_the_motion():
    stress, _ = sheared((0.0, 0.2), (0.75, 0.65))
    assert stress[..., 1] == pytest.approx(np.full((2, 6), -0.65), rel=0.02)
    assert not stress[..., 0].any()


def test_belt_laid_down_afresh_carries_less_shear_than_belt_that_slid_long():
    stress, _ = sheared((-0.02, 0.0), (0.75, 0.65), speed=0.4)
    along = stress[0, :, 0]
    assert np.all(np.diff(along) < 0.0), "thrust grows from the front bar (last) to the rear bar (first)"
    backwards, _ = sheared((0.02, 0.0), (0.75, 0.65), speed=-0.4)
    assert backwards[0, ::-1, 0] == pytest.approx(-along)


def test_bar_off_the_ground_forgets_its_shear():
    state = new_state(5, -0.015)
    state.shear[:] = 0.003
    load, zeros = np.zeros((2, 6)), np.zeros((2, 6, 2))
    shear_stress(PARAMETERS, state, load, zeros, zeros + 0.7, zeros.copy(), np.zeros(2), 0.002)
    assert not state.shear.any()
