import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tracked_description import load_robot
from tracked_navigation import MotionLimits, ReferenceSettings, find_violation, make_reference
from tracked_navigation.reference import InfeasibleTrajectoryError
from tracked_navigation.shape_settings import SHAPES, ShapeSettings
from tracked_navigation.shapes import FIRST_ZERO_OF_J0, bessel_j0, build_shape
from tracked_types import Trajectory, angle_difference

ROBOT = load_robot()


def integrate_unicycle(trajectory: Trajectory) -> np.ndarray:
    """End pose from the sampled inputs alone: linear inputs in each step, finely subdivided."""
    parts = 50
    times = np.linspace(0.0, trajectory.times_s[-1], parts * (len(trajectory.times_s) - 1) + 1)
    speeds = np.interp(times, trajectory.times_s, trajectory.inputs[:, 0])
    rates = np.interp(times, trajectory.times_s, trajectory.inputs[:, 1])
    step = times[1] - times[0]
    headings = np.concatenate(([0.0], np.cumsum(0.5 * (rates[1:] + rates[:-1]) * step)))
    middle_speed, middle_heading = 0.5 * (speeds[1:] + speeds[:-1]), 0.5 * (headings[1:] + headings[:-1])
    return np.array(
        [
            np.sum(middle_speed * np.cos(middle_heading)) * step,
            np.sum(middle_speed * np.sin(middle_heading)) * step,
            headings[-1],
        ]
    )


@pytest.mark.parametrize("shape", SHAPES)
def test_every_default_shape_can_be_driven_from_rest_to_rest(shape: str) -> None:
    trajectory = make_reference(ROBOT, ReferenceSettings(), ShapeSettings(shape=shape)).trajectory
    assert np.all(trajectory.states[0] == 0.0)
    assert trajectory.inputs[0] == pytest.approx([0.0, 0.0])
    assert trajectory.inputs[-1] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert np.diff(trajectory.times_s) == pytest.approx(0.05)


@pytest.mark.parametrize("shape", SHAPES)
def test_inputs_alone_lead_to_the_end_pose(shape: str) -> None:
    trajectory = build_shape(ShapeSettings(shape=shape))
    x, y, yaw = integrate_unicycle(trajectory)
    assert [x, y] == pytest.approx(trajectory.states[-1, :2], abs=0.005)
    assert angle_difference(yaw, float(trajectory.states[-1, 2])) == pytest.approx(0.0, abs=0.005)


@settings(deadline=None, max_examples=40)
@given(
    shape=st.sampled_from(SHAPES),
    length=st.floats(1.0, 10.0),
    slope=st.floats(-0.3, 0.3),
    radius=st.floats(0.2, 5.0),
    swings=st.integers(1, 6),
    corners=st.integers(2, 12),
)
def test_states_are_the_integral_of_the_inputs_in_every_step(
    shape: str, length: float, slope: float, radius: float, swings: int, corners: int
) -> None:
    trajectory = build_shape(
        ShapeSettings(
            shape=shape,
            length_m=length * swings,
            width_m=length * slope,
            radius_m=radius,
            swings=swings,
            corners=corners,
            speed_mps=0.3,
        )
    )
    turned = angle_difference(trajectory.states[1:, 2], trajectory.states[:-1, 2])
    mean_rate = 0.5 * (trajectory.inputs[1:, 1] + trajectory.inputs[:-1, 1])
    assert turned == pytest.approx(mean_rate * 0.05, abs=2e-3)
    moved = np.hypot(*np.diff(trajectory.states[:, :2], axis=0).T)
    mean_speed = 0.5 * (trajectory.inputs[1:, 0] + trajectory.inputs[:-1, 0])
    assert moved == pytest.approx(mean_speed * 0.05, abs=5e-4)


def test_line_ends_at_its_length() -> None:
    end = build_shape(ShapeSettings(shape="line", length_m=2.5)).states[-1]
    assert end == pytest.approx([2.5, 0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize(("swings", "side"), [(1, 0.6), (2, 0.0), (3, 0.6)])
def test_s_curve_ends_where_its_swings_add_up_to_with_the_first_heading(swings: int, side: float) -> None:
    end = build_shape(ShapeSettings(shape="s_curve", length_m=4.0, width_m=0.6, swings=swings)).states[-1]
    assert end == pytest.approx([4.0, side, 0.0], abs=1e-6)


def test_s_curve_with_negative_width_is_the_mirror_image() -> None:
    left = build_shape(ShapeSettings(width_m=0.5)).states
    right = build_shape(ShapeSettings(width_m=-0.5)).states
    assert left * [1.0, -1.0, -1.0] == pytest.approx(right, abs=1e-12)


@pytest.mark.parametrize("shape", ["circle", "figure_eight", "stop_and_turn"])
def test_closed_shapes_return_to_their_start(shape: str) -> None:
    end = build_shape(ShapeSettings(shape=shape)).states[-1]
    assert end == pytest.approx([0.0, 0.0, 0.0], abs=1e-6)


def test_circle_keeps_its_radius() -> None:
    states = build_shape(ShapeSettings(shape="circle", radius_m=0.8)).states
    assert np.hypot(states[:, 0], states[:, 1] - 0.8) == pytest.approx(0.8, abs=1e-9)


def test_figure_eight_crosses_itself_in_the_middle() -> None:
    states = build_shape(ShapeSettings(shape="figure_eight")).states
    assert np.hypot(*states[len(states) // 2, :2]) < 0.02


def test_stop_and_turn_never_drives_while_it_turns() -> None:
    inputs = build_shape(ShapeSettings(shape="stop_and_turn")).inputs
    assert np.all(inputs[:, 0] * inputs[:, 1] == 0.0)


def test_bessel_function_has_its_known_values() -> None:
    assert bessel_j0(0.0) == 1.0
    assert bessel_j0(1.0) == pytest.approx(0.7651976865579666, abs=1e-14)
    assert bessel_j0(FIRST_ZERO_OF_J0) == pytest.approx(0.0, abs=1e-14)


@pytest.mark.parametrize(
    ("shape", "reason"),
    [
        (ShapeSettings(shape="line", speed_mps=0.6), r"needs a speed of 0\.(59|6)"),
        (ShapeSettings(shape="circle", radius_m=0.2), "needs a yaw rate of 1.[67]"),
        (ShapeSettings(shape="line", acceleration_mps2=5.0), "needs an acceleration"),
        (ShapeSettings(shape="stop_and_turn", yaw_acceleration_radps2=9.0, turn_rate_radps=1.0), "a yaw acceleration"),
    ],
)
def test_shape_beyond_the_limits_is_refused_with_the_reason(shape: ShapeSettings, reason: str) -> None:
    with pytest.raises(InfeasibleTrajectoryError, match=reason):
        make_reference(ROBOT, ReferenceSettings(), shape)


def test_reference_leaves_the_controllers_their_share() -> None:
    fast = ShapeSettings(shape="line", speed_mps=0.45)
    with pytest.raises(InfeasibleTrajectoryError):
        make_reference(ROBOT, ReferenceSettings(limit_share=0.85), fast)
    make_reference(ROBOT, ReferenceSettings(limit_share=1.0), fast)


def test_track_speed_is_a_limit_of_its_own() -> None:
    limits = replace(MotionLimits.from_robot(ROBOT), track_speed_mps=0.4)
    trajectory = build_shape(ShapeSettings(shape="circle", radius_m=0.5, speed_mps=0.35))
    violation = find_violation(trajectory, limits)
    assert violation is not None and "a track speed" in violation.reason


def test_non_finite_inputs_count_as_violations() -> None:
    trajectory = build_shape(ShapeSettings(shape="line"))
    trajectory.inputs[3, 0] = math.nan
    violation = find_violation(trajectory, MotionLimits.from_robot(ROBOT))
    assert violation is not None and violation.index == 3
