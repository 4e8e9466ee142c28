"""What is handed out is held against brute force: dense samples and distances written down anew."""

import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tracked_description import load_robot
from tracked_navigation import find_violation
from tracked_navigation.band import BandSettings, TimedElasticBand
from tracked_navigation.band.scenes import disc, driven, hard_scene, random_scene, straight_path
from tracked_types import Mover, Pose2, Twist2, wrap_angle

SETTINGS = BandSettings.from_robot(load_robot())
FEET = SETTINGS.footprint
AT_REST = 0.01  # m/s of the fastest corner


@pytest.fixture(scope="module")
def band():
    return TimedElasticBand(SETTINGS)


def gap(state, point):
    """Distance of a point from the robot's rectangle by plain trigonometry; not positive if it is inside."""
    x, y, yaw = state
    ahead = math.cos(yaw) * (point[0] - x) + math.sin(yaw) * (point[1] - y)
    aside = -math.sin(yaw) * (point[0] - x) + math.cos(yaw) * (point[1] - y)
    beyond = max(ahead - FEET.front_m, -FEET.rear_m - ahead, 0.0), max(abs(aside) - FEET.half_width_m, 0.0)
    return math.hypot(*beyond)


def least_gap(trajectory, points, movers, until_s=math.inf, step_s=0.01):
    """Over the trajectory as a consumer interpolates it, while the robot moves."""
    least = math.inf
    for time in np.arange(0.0, min(float(trajectory.times_s[-1]), until_s) + 1e-9, step_s):
        states, inputs = trajectory.at(trajectory.stamp_ns, np.array([time]))
        if abs(inputs[0, 0]) + 0.4 * abs(inputs[0, 1]) < AT_REST:
            continue
        near = points[np.hypot(*(points - states[0, :2]).T) < 0.6]
        least = min([least, *(gap(states[0], point) for point in near)])
        for mover in movers:
            least = min(least, gap(states[0], mover.position_at(time)) - mover.radius_m)
    return least


def assert_follows_from_its_inputs(trajectory):
    steps, means = np.diff(trajectory.times_s), 0.5 * (trajectory.inputs[1:] + trajectory.inputs[:-1])
    turns = wrap_angle(np.diff(trajectory.states[:, 2]))
    assert turns == pytest.approx(means[:, 1] * steps, abs=1e-9)
    middle = trajectory.states[:-1, 2] + 0.5 * turns
    ways = np.diff(trajectory.states[:, :2], axis=0)
    assert ways[:, 0] == pytest.approx(means[:, 0] * steps * np.cos(middle), abs=1e-9)
    assert ways[:, 1] == pytest.approx(means[:, 0] * steps * np.sin(middle), abs=1e-9)


numbers = st.floats
discs = st.lists(st.tuples(numbers(0.5, 4.0), numbers(-1.2, 1.2), numbers(0.05, 0.4)), max_size=4)
crossing = st.lists(
    st.tuples(numbers(-2.0, 5.0), numbers(-2.0, 2.0), numbers(-0.8, 0.8), numbers(-0.8, 0.8), numbers(0.1, 0.4)),
    max_size=3,
)
starts = st.tuples(numbers(-0.2, 0.2), numbers(-0.3, 0.3), numbers(-3.1, 3.1), numbers(-0.1, 0.4), numbers(-0.6, 0.6))


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture], derandomize=True)
@given(discs, crossing, starts)
def test_nothing_handed_out_touches_anything_or_breaks_a_limit(band, circles, moving, start):
    band.forget()
    points = np.vstack([np.zeros((0, 2)), *(disc(*circle) for circle in circles)])
    movers = tuple(
        Mover(index, 0, "map", np.array(row[:2]), np.array(row[2:4]), np.eye(4), row[4])
        for index, row in enumerate(moving)
    )
    result = band.update(Pose2(*start[:3]), Twist2(*start[3:]), straight_path(5.0), points, movers, 0)
    trajectory = result.trajectory
    assert trajectory is not None and trajectory.states[0] == pytest.approx(np.array(start[:3]), abs=1e-9)
    assert find_violation(trajectory, SETTINGS.limits) is None
    assert_follows_from_its_inputs(trajectory)
    if not result.unavoidable:
        assert least_gap(trajectory, points, movers) > 0.0
    elif result.kind != "stop":
        pytest.fail(f"{result.kind} is handed out although it touches something")


@pytest.mark.parametrize("seed", range(5000, 5020))
def test_in_closed_loop_the_robot_drives_into_nothing(band, seed):
    scene = random_scene(seed)
    for moment in driven(band, scene, seed=seed):
        if not moment.result.unavoidable:
            assert (
                least_gap(
                    moment.result.trajectory, scene.points, scene.movers_at(moment.now_s), until_s=0.2, step_s=0.05
                )
                > 0.0
            )


@pytest.mark.parametrize("seed", range(5100, 5106))
def test_where_two_do_not_fit_the_robot_makes_no_contact(band, seed):
    scene = hard_scene(seed)
    for moment in driven(band, scene, seed=seed, seconds=25.0):
        gaps = least_gap(
            moment.result.trajectory, scene.points, scene.movers_at(moment.now_s), until_s=0.2, step_s=0.05
        )
        assert gaps > 0.0


def test_noise_does_not_make_it_change_sides(band):
    """A disc in the middle of the way: either side costs about the same."""
    points, random = disc(2.0, 0.0, 0.25), np.random.default_rng(3)
    band.forget()
    sides = []
    for index in range(20):
        start = Pose2(0.02 * index, float(random.normal(0.0, 0.01)), float(random.normal(0.0, 0.01)))
        noisy = points + random.normal(0.0, 0.01, points.shape)
        result = band.update(start, Twist2(0.1, 0.0), straight_path(5.0), noisy, (), index * 200_000_000)
        beside = np.abs(result.trajectory.states[:, 0] - 2.0).argmin()
        sides.append(np.sign(result.trajectory.states[beside, 1]))
    assert len(set(sides)) == 1


def test_a_way_that_is_much_better_is_changed_to(band):
    """The side that the band took is closed farther on."""
    band.forget()
    path, stamp = straight_path(6.0), 0
    first = band.update(Pose2(0.0, 0.0, 0.0), Twist2(0.0, 0.0), path, disc(2.0, -0.05, 0.3), (), stamp)
    side = float(np.sign(first.trajectory.states[np.abs(first.trajectory.states[:, 0] - 2.0).argmin(), 1]))
    wall = np.column_stack([np.full(60, 2.0), side * np.linspace(0.3, 3.0, 60)])
    for _ in range(8):
        stamp += 200_000_000
        found = band.update(
            Pose2(0.0, 0.0, 0.0), Twist2(0.0, 0.0), path, np.vstack([disc(2.0, -0.05, 0.3), wall]), (), stamp
        )
    beside = np.abs(found.trajectory.states[:, 0] - 2.0).argmin()
    assert np.sign(found.trajectory.states[beside, 1]) == -side
