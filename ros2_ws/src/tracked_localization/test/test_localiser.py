import numpy as np
import pytest

from tracked_localization.localisation.localiser import Localiser, LocaliserSettings
from tracked_localization.mapping.log_odds_grid import LogOddsGrid, LogOddsSettings
from tracked_localization.matching.line_world import CORRIDOR, ROOM
from tracked_localization.matching.scan_matcher import MatchSettings
from tracked_localization.matching.wall_field import WallField
from tracked_types import Pose2, angle_difference
from tracked_types.scan_points import ScanPoints, scan_points

LIDAR, PERIOD_NS = Pose2(0.0, 0.0, 0.0), 10**8
NARROW = np.diag([1e-4, 1e-4, 1e-4])


def field_of(world, places):
    grid = LogOddsGrid(LogOddsSettings(), "map")
    for x, y in places:
        grid.add(scan_points(world.scan(Pose2(x, y, 0.0)), LIDAR), Pose2(x, y, 0.0))
    return WallField(grid.as_map())


ROOM_FIELD = field_of(ROOM, [(-3.0, 0.0), (0.0, 1.0), (0.0, -2.0), (3.0, 2.0), (4.0, -2.0)])
CORRIDOR_FIELD = field_of(CORRIDOR, [(0.1 * step, 0.0) for step in range(-80, 81)])


def localiser(field=ROOM_FIELD, start=Pose2(1.0, 0.5, 0.0), covariance=None, **options):  # noqa: B008
    return Localiser(LocaliserSettings(**options), MatchSettings(), field, start, covariance)


def follow(made, truth, steps, *, lost=0.9, world=ROOM, seed=0, first_ns=0):
    """Errors (n, 3) along a drive whose odometry sees a share of every turn, and every answer."""
    generator, odometry, errors, answers = np.random.default_rng(seed), Pose2(0.0, 0.0, 0.0), [], []
    for index, step in enumerate(steps):
        truth = truth.compose(step)
        odometry = odometry.compose(Pose2(step.x_m, step.y_m, lost * step.yaw_rad))
        points = scan_points(world.scan(truth, generator, stamp_ns=first_ns + index * PERIOD_NS), LIDAR)
        answers.append(made.add(points, odometry))
        error = answers[-1].pose.as_array() - truth.as_array()
        errors.append([error[0], error[1], angle_difference(answers[-1].pose.yaw_rad, truth.yaw_rad)])
    return np.array(errors), answers


def test_spot_turns_that_odometry_underrates_do_not_lose_the_robot():
    steps = [Pose2(0.0, 0.0, 0.13)] * 100 + [Pose2(0.03, 0.0, 0.02)] * 100
    errors, answers = follow(localiser(), Pose2(1.0, 0.5, 0.0), steps, lost=0.95)
    rms = np.sqrt((errors[5:] ** 2).mean(axis=0))
    assert rms[0] < 0.015 and rms[1] < 0.015 and rms[2] < 0.008
    assert not any(answer.lost for answer in answers)


def test_a_wrong_guess_of_where_it_starts_is_mended():
    errors, answers = follow(localiser(start=Pose2(1.2, 0.3, 0.1)), Pose2(1.0, 0.5, 0.0), [Pose2(0.03, 0.0, 0.0)] * 10)
    assert np.abs(errors[-1]).max() < 0.02 and answers[-1].used


def test_the_covariance_tells_how_wrong_the_pose_is():
    squares = []
    for seed in range(20):
        errors, answers = follow(localiser(), Pose2(1.0, 0.5, 0.0), [Pose2(0.03, 0.0, 0.04)] * 20, seed=seed, lost=0.97)
        squares.append(errors[-1] @ np.linalg.solve(answers[-1].covariance, errors[-1]))
    assert np.mean(squares) < 6.0  # three degrees of freedom


def test_in_a_corridor_the_way_along_it_stays_with_odometry_and_grows_unsure():
    made = localiser(CORRIDOR_FIELD, Pose2(-4.0, 0.0, 0.0), NARROW)
    odometry, answers = Pose2(0.0, 0.0, 0.0), []
    for index in range(100):
        truth = Pose2(-4.0 + 0.05 * index, 0.0, 0.0)
        odometry = Pose2(0.05 * index * 1.02, 0.002 * index, 0.0)
        points = scan_points(CORRIDOR.scan(truth, stamp_ns=index * PERIOD_NS), LIDAR)
        answers.append(made.add(points, odometry))
    last = answers[-1]
    assert last.used and last.match.seen == 2
    assert last.pose.x_m == pytest.approx(-4.0 + odometry.x_m, abs=0.05)
    assert last.pose.y_m == pytest.approx(0.0, abs=0.02)
    assert last.covariance[0, 0] > 4.0 * answers[10].covariance[0, 0] > 4.0 * last.covariance[1, 1]


def test_a_kidnapped_robot_is_lost_within_two_seconds_and_found_when_told():
    made = localiser()
    follow(made, Pose2(1.0, 0.5, 0.0), [Pose2(0.03, 0.0, 0.0)] * 10)
    _, answers = follow(made, Pose2(-3.0, -2.0, 1.0), [Pose2(0.02, 0.0, 0.01)] * 20, first_ns=10 * PERIOD_NS)
    assert answers[-1].lost and answers[-1].reason
    made.restart(Pose2(-2.7, -1.6, 1.1))
    errors, answers = follow(made, answers_end(Pose2(-3.0, -2.0, 1.0)), [Pose2(0.0, 0.0, 0.0)] * 10)
    assert not answers[-1].lost and np.abs(errors[-1]).max() < 0.02


def answers_end(pose):
    for _ in range(20):
        pose = pose.compose(Pose2(0.02, 0.0, 0.01))
    return pose


def test_scans_without_returns_make_a_robot_lost_and_leave_it_to_odometry():
    made = localiser()
    for index in range(15):
        empty = ScanPoints(index * PERIOD_NS, np.zeros((0, 2)), np.zeros((0, 2)), (0.0, 0.0))
        answer = made.add(empty, Pose2(0.1 * index, 0.0, 0.0))
    assert answer.lost and answer.pose.x_m == pytest.approx(1.0 + 1.4)
    assert "nothing" in answer.reason


@pytest.mark.parametrize(
    ("pose", "covariance"),
    [
        (Pose2(np.nan, 0.0, 0.0), None),
        (Pose2(0.0, 0.0, 0.0), np.zeros((3, 3))),
        (Pose2(0.0, 0.0, 0.0), np.diag([1.0, np.inf, 1.0])),
        (Pose2(0.0, 0.0, 0.0), np.array([[1.0, 2.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])),
    ],
)
def test_a_start_that_means_nothing_is_refused(pose, covariance):
    with pytest.raises(ValueError, match="must be"):
        localiser().restart(pose, covariance)


def test_one_scan_that_fits_elsewhere_is_not_believed_and_several_are():
    made = localiser()
    follow(made, Pose2(1.0, 0.5, 0.0), [Pose2(0.0, 0.0, 0.0)] * 10)
    shifted = Pose2(1.3, 0.5, 0.0)
    errors, answers = follow(made, shifted, [Pose2(0.0, 0.0, 0.0)] * 10, first_ns=10 * PERIOD_NS)
    assert "from odometry" in answers[0].reason and abs(errors[0, 0] + 0.3) < 0.02
    assert answers[-1].used and np.abs(errors[-1]).max() < 0.02
