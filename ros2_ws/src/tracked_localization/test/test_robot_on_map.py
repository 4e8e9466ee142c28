import numpy as np
import pytest

from tracked_localization.localisation.global_search import SearchSettings
from tracked_localization.localisation.localiser import LocaliserSettings
from tracked_localization.localisation.odometry_anchor import AnchorSettings
from tracked_localization.localisation.robot_on_map import Phase, RobotOnMap, RobotOnMapSettings
from tracked_localization.mapping.log_odds_grid import LogOddsGrid, LogOddsSettings
from tracked_localization.matching.line_world import ROOM
from tracked_localization.matching.scan_alignment import AlignedScan
from tracked_localization.matching.scan_matcher import MatchSettings
from tracked_types import FREE, UNKNOWN, OccupancyMap, Pose2
from tracked_types.scan_points import scan_points

LIDAR, PERIOD_NS, TRUTH = Pose2(0.0, 0.0, 0.0), 10**8, Pose2(1.0, 0.5, 0.3)


def room_map():
    grid = LogOddsGrid(LogOddsSettings(), "map")
    for x, y in [(-3.0, 0.0), (0.0, 1.0), (0.0, -2.0), (3.0, 2.0), (4.0, -2.0)]:
        for _ in range(4):
            grid.add(scan_points(ROOM.scan(Pose2(x, y, 0.0)), LIDAR), Pose2(x, y, 0.0))
    return grid.as_map()


ROOM_MAP = room_map()


def robot(**options):
    parts = (LocaliserSettings(), MatchSettings(), SearchSettings(), AnchorSettings())
    made = RobotOnMap(RobotOnMapSettings(**options), *parts)
    made.set_map(ROOM_MAP)
    return made


def see(made, truth, scans, first=0, odom_pose=LIDAR):
    """The robot stands; between two scans searches go on. Answers of all scans."""
    answers = []
    for index in range(first, first + scans):
        points = scan_points(ROOM.scan(truth, np.random.default_rng(index), stamp_ns=index * PERIOD_NS), LIDAR)
        answers.append(made.add(AlignedScan(points, odom_pose)))
        for tick in range(6):
            made.work(index * PERIOD_NS + tick * PERIOD_NS // 6)
    return answers


def off_by(answer, truth):
    offset = truth.inverse().compose(answer.localised.pose)
    return np.hypot(offset.x_m, offset.y_m)


def test_a_robot_that_is_told_nearly_where_it_is_is_localised():
    made = robot()
    made.set_pose(Pose2(1.3, 0.3, 0.1))
    answers = see(made, TRUTH, 5)
    assert made.phase is Phase.LOCALISED and off_by(answers[-1], TRUTH) < 0.02


def test_a_robot_that_nobody_placed_finds_itself():
    made = robot()
    assert made.phase is Phase.NO_POSE
    answers = see(made, TRUTH, 12)
    assert made.phase is Phase.LOCALISED and off_by(answers[-1], TRUTH) < 0.02


def test_a_kidnapped_robot_says_that_it_is_lost_and_finds_itself_again():
    made, elsewhere, phases = robot(), Pose2(-3.0, 2.0, -1.0), []
    made.set_pose(TRUTH)
    see(made, TRUTH, 5)
    for index in range(5, 40):
        answers = see(made, elsewhere, 1, first=index)
        phases.append(made.phase)
    assert any(phase in (Phase.LOST, Phase.SEARCHING) for phase in phases[:20])
    assert made.phase is Phase.LOCALISED and off_by(answers[-1], elsewhere) < 0.02


def test_without_searching_a_lost_robot_stays_lost_and_says_so():
    made = robot(relocalise_when_lost=False)
    made.set_pose(TRUTH)
    see(made, TRUTH, 5)
    see(made, Pose2(-3.0, 2.0, -1.0), 25, first=5)
    assert made.phase is Phase.LOST and made.reason


def test_scans_that_cease_make_the_robot_lost():
    made = robot()
    made.set_pose(TRUTH)
    see(made, TRUTH, 5)
    made.work(4 * PERIOD_NS + 2 * 10**9)
    assert made.phase is Phase.LOST and "no scan" in made.reason


def test_a_search_on_request_without_map_or_scan_gives_the_reason():
    bare = RobotOnMap(RobotOnMapSettings(), LocaliserSettings(), MatchSettings(), SearchSettings(), AnchorSettings())
    assert "no map" in bare.search_now() and "no scan" in robot().search_now()
    assert bare.add(AlignedScan(scan_points(ROOM.scan(TRUTH), LIDAR), LIDAR)) is None


@pytest.mark.parametrize("fill", [UNKNOWN, FREE])
def test_a_map_of_nothing_is_refused_and_the_one_before_stays(fill):
    made = robot()
    made.set_pose(TRUTH)
    with pytest.raises(ValueError, match="map"):
        made.set_map(OccupancyMap("map", 0.05, LIDAR, np.full((9, 9), fill, np.int8)))
    see(made, TRUTH, 5)
    assert made.phase is Phase.LOCALISED


def test_a_pose_that_is_not_finite_is_refused():
    with pytest.raises(ValueError, match="finite"):
        robot().set_pose(Pose2(np.nan, 0.0, 0.0))


def test_a_corrected_odometry_gets_measurements_in_its_own_frame():
    made, odom_pose = robot(correct_odometry=True), Pose2(5.0, 5.0, 1.0)
    made.set_pose(TRUTH)
    answers = see(made, TRUTH, 8, odom_pose=odom_pose)
    measured = answers[-1].measured
    assert measured.frame_id == "odom"
    assert measured.pose.as_array() == pytest.approx(odom_pose.as_array(), abs=0.03)


def test_a_clock_that_is_set_back_does_not_lose_the_robot():
    made = robot()
    made.set_pose(TRUTH)
    see(made, TRUTH, 5, first=100)
    answers = see(made, TRUTH, 5, first=0)
    assert made.phase is Phase.LOCALISED and off_by(answers[-1], TRUTH) < 0.02
