"""What the band does with good and bad input, one update at a time."""

from dataclasses import replace

import numpy as np
import pytest

from tracked_description import load_robot
from tracked_navigation.band import BandSettings, TimedElasticBand
from tracked_navigation.band.scenes import corridor, disc, straight_path
from tracked_types import Mover, Pose2, Twist2

SETTINGS = BandSettings.from_robot(load_robot())
ORIGIN, REST = Pose2(0.0, 0.0, 0.0), Twist2(0.0, 0.0)
NOTHING = np.zeros((0, 2))
PATH = straight_path(5.0)


@pytest.fixture(scope="module")
def compiled_band():
    return TimedElasticBand(SETTINGS)


@pytest.fixture
def band(compiled_band):
    compiled_band.forget()
    return compiled_band


def mover(x, y, vx, vy, radius=0.25, frame="map", stamp_ns=0):
    return Mover(1, stamp_ns, frame, np.array([x, y]), np.array([vx, vy]), 1e-3 * np.eye(4), radius)


def plan(band, *, start=ORIGIN, twist=REST, path=PATH, points=NOTHING, movers=(), stamp_ns=0, **more):
    return band.update(start, twist, path, points, movers, stamp_ns, **more)


def assert_stops(result, words):
    assert result.kind == "stop" and words in result.reason
    assert (result.trajectory.inputs[-1] == 0.0).all()


def test_it_starts_from_the_robots_state_and_speed(band):
    result = plan(band, start=Pose2(0.3, 0.1, 0.2), twist=Twist2(0.3, -0.1), stamp_ns=17)
    trajectory = result.trajectory
    assert result.kind == "band" and trajectory.start_ns == 17 and trajectory.frame_id == "map"
    assert trajectory.states[0] == pytest.approx([0.3, 0.1, 0.2]) and trajectory.inputs[0] == pytest.approx([0.3, -0.1])


def test_it_passes_the_local_goal_moving_and_stands_at_the_goal(band):
    far = plan(band).trajectory
    assert far.inputs[-1, 0] > 0.3 and far.states[-1, 0] == pytest.approx(2.5, abs=0.1)
    band.forget()
    near = plan(band, path=straight_path(1.5)).trajectory
    assert (near.inputs[-1] == 0.0).all() and near.states[-1] == pytest.approx([1.5, 0.0, 0.0], abs=0.03)


def test_in_the_open_it_takes_little_longer_than_driving_at_the_limit(band):
    trajectory = plan(band, path=straight_path(2.0)).trajectory
    assert trajectory.times_s[-1] < 2.0 / SETTINGS.cruise_mps + 1.0


@pytest.mark.parametrize("yaw", [np.pi, -2.5, 1.8])
def test_it_turns_on_the_spot_to_a_path_behind(band, yaw):
    result = plan(band, start=Pose2(0.0, 0.0, yaw))
    assert result.kind == "band"
    assert result.trajectory.states[:, 0].min() > -0.4


def test_it_backs_into_a_goal_close_behind(band):
    result = plan(band, path=np.array([[0.0, 0.0, 0.0], [-0.3, 0.0, 0.0]]))
    assert result.kind == "band" and result.trajectory.inputs[:, 0].min() < -0.05
    assert result.trajectory.states[-1] == pytest.approx([-0.3, 0.0, 0.0], abs=0.03)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_it_passes_an_obstacle_on_the_side_with_room(band, side):
    result = plan(band, points=disc(1.4, 0.15 * side, 0.2))
    assert result.kind == "band"
    assert side * result.trajectory.states[:, 1].min() < 0.0 or side * result.trajectory.states[:, 1].max() < 0.0


def test_a_segment_counts_like_its_points(band):
    wall = np.array([[[1.2, -0.1], [1.2, 3.0]]])
    result = plan(band, segments=wall)
    assert result.kind == "band" and result.trajectory.states[:, 1].min() < -0.2


def test_a_thin_segment_across_a_corridor_stops_it(band):
    result = plan(band, points=corridor(0.6, 5.0), segments=np.array([[[1.5, -0.6], [1.5, 0.6]]]))
    assert result.kind in ("band", "stop") and result.reason
    assert result.trajectory.states[-1, 0] < 1.5 - SETTINGS.footprint.front_m
    assert (result.trajectory.inputs[-1] == 0.0).all()


def test_it_waits_before_a_goal_that_is_not_free(band):
    result = plan(band, path=straight_path(2.0), points=disc(2.0, 0.0, 0.1))
    assert result.kind == "band" and result.reason == "the goal is not free"
    assert (result.trajectory.inputs[-1] == 0.0).all() and result.trajectory.states[-1, 0] < 1.6


def test_it_gives_way_to_a_mover_that_crosses(band):
    result = plan(band, movers=(mover(1.5, -1.5, 0.0, 0.4),))
    trajectory = result.trajectory
    places = np.array([1.5, -1.5]) + trajectory.times_s[:, None] * np.array([0.0, 0.4])
    turned = np.array(
        [
            Pose2(*state).inverse().transform(place[None])[0]
            for state, place in zip(trajectory.states, places, strict=True)
        ]
    )
    assert result.kind == "band" and (SETTINGS.footprint.distance(turned) > 0.25 + 0.02).all()


def test_it_brakes_from_speed_before_a_wall_that_appears(band):
    wall = np.array([[[0.6, -3.0], [0.6, 3.0]]])
    result = plan(band, twist=Twist2(0.4, 0.0), path=straight_path(4.0), segments=wall)
    assert (result.trajectory.inputs[-1] == 0.0).all() and not result.unavoidable
    assert result.trajectory.states[:, 0].max() + SETTINGS.footprint.front_m < 0.6


def test_what_cannot_be_avoided_is_said_and_braked_for(band):
    wall = np.array([[[0.36, -3.0], [0.36, 3.0]]])
    result = plan(band, twist=Twist2(0.4, 0.0), path=straight_path(4.0), segments=wall)
    assert_stops(result, "") and result.unavoidable
    speeds = result.trajectory.inputs[:, 0]
    assert (np.diff(speeds) <= 0.0).all()


def test_at_the_goal_it_has_arrived(band):
    result = plan(band, start=Pose2(5.0, 0.005, 0.01))
    assert result.kind == "arrived" and (result.trajectory.inputs == 0.0).all()


def test_goal_equal_to_start_has_arrived(band):
    assert plan(band, path=np.zeros((1, 3))).kind == "arrived"


@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize("entry", range(5))
def test_a_state_that_is_not_finite_gives_no_trajectory(band, bad, entry):
    values = [0.0] * 5
    values[entry] = bad
    result = plan(band, start=Pose2(*values[:3]), twist=Twist2(*values[3:]))
    assert result.trajectory is None and result.kind == "none" and "not finite" in result.reason


@pytest.mark.parametrize(
    ("path", "words"),
    [
        (np.zeros((0, 3)), "empty"),
        (np.zeros((4, 2)), "shape"),
        (np.array([[0.0, np.nan, 0.0]]), "not finite"),
        (np.array([[1.0, 0.0, np.inf]]), "not finite"),
    ],
)
def test_a_bad_path_stops_a_moving_robot(band, path, words):
    result = plan(band, twist=Twist2(0.4, 0.3), path=path)
    assert_stops(result, words)
    assert result.trajectory.inputs[0] == pytest.approx([0.4, 0.3])


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"points": np.array([[1.0, np.nan]])}, "not finite"),
        ({"points": np.zeros((3, 3))}, "shape"),
        ({"segments": np.zeros((1, 4))}, "shape"),
        ({"movers": (mover(1.0, 0.0, np.nan, 0.0),)}, "mover 1"),
        ({"movers": (mover(1.0, 0.0, 0.0, 0.0, radius=-1.0),)}, "mover 1"),
        ({"movers": (mover(1.0, 0.0, 0.0, 0.0, frame="odom"),)}, "frame 'odom'"),
    ],
)
def test_bad_surroundings_stop_the_robot_and_are_named(band, more, words):
    assert_stops(plan(band, twist=Twist2(0.3, 0.0), **more), words)


def test_a_start_in_collision_stays_where_it_is(band):
    result = plan(band, points=np.array([[0.1, 0.05]]))
    assert_stops(result, "touches")
    assert (result.trajectory.inputs == 0.0).all()


def test_a_walled_in_robot_stops_and_says_why(band):
    assert_stops(plan(band, points=disc(0.0, 0.0, 0.43, 200)), "")


def test_a_mover_faster_than_the_robot_from_behind_is_nobodys_fault(band):
    result = plan(band, movers=(mover(-2.0, 0.0, 2.0, 0.0),))
    assert result.trajectory is not None and result.reason


def test_a_path_of_500_poses_and_500_points_is_planned(band):
    random = np.random.default_rng(4)
    points = np.column_stack(
        [random.uniform(-1.0, 5.0, 500), random.choice([-1.0, 1.0], 500) * random.uniform(0.6, 2, 500)]
    )
    path = np.column_stack([np.linspace(0.0, 5.0, 500), np.zeros(500), np.zeros(500)])
    assert plan(band, path=path, points=points).kind == "band"


def test_poses_of_a_path_that_repeat_do_no_harm(band):
    assert plan(band, path=np.repeat(PATH, 3, axis=0)).kind == "band"


def test_obstacles_given_twice_change_nothing(band):
    points = disc(1.5, 0.2, 0.2)
    once = plan(band, points=points)
    band.forget()
    twice = plan(band, points=np.vstack([points, points]))
    assert np.array_equal(once.trajectory.states, twice.trajectory.states)


def test_a_mover_is_carried_on_from_its_own_stamp(band):
    now = 1_000_000_000
    early = plan(band, movers=(mover(1.0, -1.0, 0.0, 0.4, stamp_ns=0),), stamp_ns=now)
    band.forget()
    late = plan(band, movers=(mover(1.0, -0.6, 0.0, 0.4, stamp_ns=now),), stamp_ns=now)
    assert early.trajectory.states == pytest.approx(late.trajectory.states)


def test_stamps_that_go_back_start_anew(band):
    plan(band, stamp_ns=5_000_000_000)
    assert plan(band, stamp_ns=1_000_000_000).kind == "band"


def test_equal_inputs_give_equal_results(band):
    points = disc(1.3, 0.1, 0.25)
    crossing = (mover(2.0, -1.5, 0.0, 0.3),)
    first = plan(band, points=points, movers=crossing)
    other = TimedElasticBand(SETTINGS)
    again = plan(other, points=points, movers=crossing)
    assert np.array_equal(first.trajectory.states, again.trajectory.states) and first.reason == again.reason


def test_without_compiler_the_result_is_the_same(band):
    slow = TimedElasticBand(replace(SETTINGS, compile_solver=False))
    points = disc(1.3, 0.1, 0.25)
    expected, found = plan(band, points=points), plan(slow, points=points)
    assert found.kind == expected.kind == "band"
    assert found.trajectory.times_s[-1] == pytest.approx(expected.trajectory.times_s[-1], rel=0.02)


def test_settings_out_of_range_are_named():
    with pytest.raises(ValueError, match="lookahead_m"):
        BandSettings.from_robot(load_robot(), lookahead_m=0.0)
    with pytest.raises(ValueError, match="least_clearance_m"):
        BandSettings.from_robot(load_robot(), clearance_m=0.01, least_clearance_m=0.05)
