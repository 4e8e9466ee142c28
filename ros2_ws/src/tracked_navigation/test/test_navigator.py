"""The navigator over an ideal base that follows every reference exactly, in a room with a lidar that sees all."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tracked_description import load_robot
from tracked_navigation.band import BandSettings, TimedElasticBand
from tracked_navigation.movers.mover_tracker import MoverSettings
from tracked_navigation.navigator import Navigator, NavigatorSettings, Outcome
from tracked_navigation.planning.costmap import CostSettings
from tracked_types import FREE, OCCUPIED, OccupancyMap, Odometry, Pose2, ScanPoints, Trajectory, Twist2

ROBOT = load_robot()
BAND = TimedElasticBand(BandSettings.from_robot(ROBOT))
PERIOD_NS = 200_000_000
HERE = Pose2(0.0, 0.0, 0.0)


def room(length_m=6.0, width_m=4.0):
    """Walls around [-1, length - 1] x [-width / 2, width / 2]."""
    occupancy = np.full((round(width_m / 0.05), round(length_m / 0.05)), FREE, np.int8)
    occupancy[[0, -1]] = occupancy[:, [0, -1]] = OCCUPIED
    return OccupancyMap("map", 0.05, Pose2(-1.0, -width_m / 2.0, 0.0), occupancy)


class Drive:
    """Base, lidar and localisation without error; the odometry's frame lies at a place of its own in the map."""

    def __init__(self, occupancy_map=None, **tuning):
        self.navigator = Navigator(NavigatorSettings(**tuning), BAND, CostSettings.from_robot(ROBOT), MoverSettings())
        BAND.forget()
        self.map = occupancy_map or room()
        self.navigator.set_map(self.map)
        self.odom_in_map = self.known = Pose2(0.3, -0.2, 0.5)
        self.pose, self.twist, self.now_ns = HERE, Twist2(0.0, 0.0), PERIOD_NS
        self.unmapped = np.zeros((0, 2))
        self.sees = True
        self.reference: Trajectory | None = None
        self.references: list[Trajectory] = []

    def step(self):
        """One period: the base drives on, the lidar looks, the navigator decides."""
        if self.reference is not None:
            states, inputs = self.reference.at(self.now_ns, np.zeros(1))
            self.pose = self.odom_in_map.compose(Pose2(*states[0].tolist()))
            self.twist = Twist2(*inputs[0].tolist())
        if self.sees:
            walls = self.map.centres_of(np.argwhere(self.map.occupied))
            hits = self.pose.inverse().transform(np.vstack([walls, self.unmapped]))
            self.navigator.see(ScanPoints(self.now_ns, hits, np.zeros((0, 2)), (0.0, 0.0)), self.pose)
        in_odom = self.odom_in_map.inverse().compose(self.pose)
        odometry = Odometry(self.now_ns, "odom", "base", in_odom, self.twist, np.eye(3), np.eye(2))
        output = self.navigator.update(odometry, self.known)
        if output is not None and output.reference is not None:
            self.reference = output.reference
            self.references.append(output.reference)
        self.now_ns += PERIOD_NS
        return output

    def until_finished(self, seconds=60.0):
        for _ in range(round(seconds * 5)):
            output = self.step()
            if output is not None and output.finished is not None:
                return output.finished
        raise AssertionError("it has not ended")


def test_drives_to_the_goal_and_rests_there_whatever_the_frame_of_the_odometry():
    drive = Drive()
    drive.navigator.go([Pose2(3.0, 0.8, 1.0)])
    finished = drive.until_finished()
    assert finished.outcome is Outcome.SUCCEEDED
    assert finished.position_error_m <= 0.03 and finished.yaw_error_rad <= 0.04
    assert {reference.frame_id for reference in drive.references} == {"odom"}
    assert not drive.navigator.busy


def test_references_begin_at_the_instant_and_where_the_last_one_was_then():
    drive = Drive()
    drive.navigator.go([Pose2(3.0, 0.0, 0.0)])
    drive.until_finished()
    for before, after in zip(drive.references[2:], drive.references[3:], strict=False):
        assert after.start_ns - before.start_ns == PERIOD_NS
        at_begin, _ = before.at(after.start_ns, np.zeros(1))
        assert np.hypot(*(at_begin[0, :2] - after.states[0, :2])) < 0.02


def test_passes_goals_on_the_way_without_stopping():
    drive = Drive()
    drive.navigator.go([Pose2(1.2, 0.9, -2.0), Pose2(3.0, 0.0, 0.0)])
    nearest, slowest = math.inf, math.inf
    while drive.navigator.busy:
        drive.step()
        away = math.hypot(drive.pose.x_m - 1.2, drive.pose.y_m - 0.9)
        nearest = min(nearest, away)
        if away < 0.5:
            slowest = min(slowest, drive.twist.speed_mps)
    assert nearest < 0.31 and slowest > 0.1


def test_goes_round_what_the_map_does_not_show_and_remembers_it_when_it_looks_away():
    drive = Drive(room(6.0, 3.0))
    drive.unmapped = np.column_stack([np.full(17, 1.5), np.linspace(-0.8, 1.45, 17)])  # leaves a gap to one side only
    drive.navigator.go([Pose2(3.5, 0.6, 0.0)])
    assert drive.until_finished().outcome is Outcome.SUCCEEDED


def test_without_a_way_on_the_map_the_reason_and_the_nearest_place_come_at_once():
    drive = Drive()
    drive.navigator.go([Pose2(30.0, 0.0, 0.0)])
    finished = drive.until_finished(1.0)
    assert finished.outcome is Outcome.ABORTED and "outside the map" in finished.reason
    assert finished.nearest is not None and finished.nearest[0] > 3.0


def test_way_that_is_blocked_for_long_is_given_up_and_the_robot_stands():
    drive = Drive(room(6.0, 3.0), patience_s=3.0)
    drive.unmapped = np.column_stack([np.full(40, 1.5), np.linspace(-1.5, 1.5, 40)])
    drive.navigator.go([Pose2(3.5, 0.0, 0.0)])
    finished = drive.until_finished(20.0)
    assert finished.outcome is Outcome.ABORTED and "no headway" in finished.reason
    assert drive.reference.inputs[-1].tolist() == [0.0, 0.0]
    for _ in range(10):
        drive.step()
    assert abs(drive.twist.speed_mps) < 1e-9 and drive.pose.x_m < 1.3


@pytest.mark.parametrize(
    ("trouble", "reason"), [("lost", "does not know where it is"), ("blind", "no scan for"), ("nan", "not finite")]
)
def test_robot_stops_with_the_reason_while_it_cannot_know_and_then_goes_on(trouble, reason):
    drive = Drive()
    drive.navigator.go([Pose2(3.0, 0.0, 0.0)])
    for _ in range(10):
        drive.step()
    assert drive.twist.speed_mps > 0.1
    drive.known = None if trouble == "lost" else drive.known
    drive.sees = trouble != "blind"
    said = set()
    for _ in range(8):
        if trouble == "nan":
            drive.twist = Twist2(math.nan, 0.0)
            in_odom = drive.odom_in_map.inverse().compose(drive.pose)
            odometry = Odometry(drive.now_ns, "odom", "base", in_odom, drive.twist, np.eye(3), np.eye(2))
            output = drive.navigator.update(odometry, drive.known)
            drive.now_ns += PERIOD_NS
            assert output.reference.inputs[-1].tolist() == [0.0, 0.0]
            drive.reference, drive.twist = None, Twist2(0.0, 0.0)
        else:
            output = drive.step()
        said.add(output.progress.waits)
    assert any(reason in sentence for sentence in said)
    assert abs(drive.twist.speed_mps) < 1e-6
    drive.known, drive.sees = drive.odom_in_map, True
    assert drive.until_finished().outcome is Outcome.SUCCEEDED


def test_cancelled_in_motion_it_brakes_to_rest_and_says_so_once():
    drive = Drive()
    drive.navigator.go([Pose2(3.0, 0.0, 0.0)])
    for _ in range(10):
        drive.step()
    drive.navigator.cancel()
    output = drive.step()
    assert output.finished.outcome is Outcome.CANCELLED
    assert output.reference.inputs[-1].tolist() == [0.0, 0.0]
    assert drive.step().finished is None


def test_cancelled_robot_that_brakes_worse_than_it_was_told_is_not_sent_back():
    drive = Drive()
    drive.navigator.go([Pose2(3.0, 0.0, 0.0)])
    for _ in range(10):
        drive.step()
    drive.navigator.cancel()
    drive.step()
    for _ in range(3):  # it slides on instead of following the reference
        drive.reference = None
        drive.pose = drive.pose.compose(Pose2(0.05, 0.0, 0.0))
        drive.step()
    drive.reference, drive.twist = None, Twist2(0.0, 0.0)
    stood = drive.step().reference
    assert stood.inputs.tolist() == [[0.0, 0.0]]
    here = drive.odom_in_map.compose(Pose2(*stood.states[-1].tolist()))
    assert (here.x_m, here.y_m) == pytest.approx((drive.pose.x_m, drive.pose.y_m), abs=1e-9)
    assert drive.step().reference is None


def test_clock_that_is_set_back_ends_the_request():
    drive = Drive()
    drive.navigator.go([Pose2(3.0, 0.0, 0.0)])
    for _ in range(10):
        drive.step()
    drive.now_ns, drive.reference = PERIOD_NS, None
    finished = drive.until_finished(2.0)
    assert finished.outcome is Outcome.ABORTED and "clock" in finished.reason


def test_robot_that_is_found_elsewhere_plans_anew_from_there():
    drive = Drive()
    drive.navigator.go([Pose2(3.0, 0.0, 0.0)])
    for _ in range(10):
        drive.step()
    moved = Pose2(0.4, 1.0, 0.3).compose(drive.odom_in_map)
    drive.odom_in_map = drive.known = moved
    assert drive.until_finished().outcome is Outcome.SUCCEEDED


def test_goals_need_a_map_and_finite_numbers():
    navigator = Navigator(NavigatorSettings(), BAND, CostSettings.from_robot(ROBOT), MoverSettings())
    with pytest.raises(ValueError, match="no map yet"):
        navigator.go([HERE])
    navigator.set_map(room())
    with pytest.raises(ValueError, match="no goal"):
        navigator.go([])
    with pytest.raises(ValueError, match="goal 2 of 2 is not finite"):
        navigator.go([HERE, Pose2(0.0, math.inf, 0.0)])
    assert not navigator.busy


ANY = st.one_of(st.floats(-3.0, 3.0), st.floats(allow_nan=True, allow_infinity=True))


@settings(max_examples=30, deadline=None)
@given(rows=st.lists(st.tuples(st.integers(-(10**9), 10**10), ANY, ANY, ANY, ANY), max_size=12))
def test_odometry_of_any_kind_never_breaks_it_and_every_reference_ends_or_moves_within_limits(rows):
    drive = Drive()
    drive.navigator.go([Pose2(3.0, 0.0, 0.0)])
    for stamp_ns, x, y, yaw, speed in rows:
        odometry = Odometry(stamp_ns, "odom", "base", Pose2(x, y, yaw), Twist2(speed, 0.0), np.eye(3), np.eye(2))
        output = drive.navigator.update(odometry, drive.known)
        if output is not None and output.reference is not None and math.isfinite(x + y + yaw):
            assert np.isfinite(output.reference.states).all() and np.isfinite(output.reference.inputs).all()
