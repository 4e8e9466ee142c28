"""Loops: a ring corridor that drift would draw twice, and loops that are none."""

import importlib.util
import math

import numpy as np
import pytest

from tracked_localization.mapping.log_odds_grid import LogOddsSettings
from tracked_localization.mapping.mapper import MapperSettings
from tracked_localization.matching.line_world import LineWorld
from tracked_localization.matching.scan_matcher import MatchSettings
from tracked_localization.pose_graph.graph_solver import fitted, misfit
from tracked_localization.pose_graph.key_scan import Edge
from tracked_localization.pose_graph.loop_closer import LoopCloser
from tracked_localization.pose_graph.loop_closing_mapper import LoopClosingMapper
from tracked_localization.pose_graph.settings import LoopSettings
from tracked_types import Pose2, ScanPoints, angle_difference
from tracked_types.scan_points import scan_points

HERE = Pose2(0.0, 0.0, 0.0)
SURE, UNSURE = np.diag([1e4, 1e4, 1e5]), np.diag([400.0, 400.0, 4e3])


def box(x0, y0, x1, y1):
    return [[[x0, y0], [x1, y0]], [[x1, y0], [x1, y1]], [[x1, y1], [x0, y1]], [[x0, y1], [x0, y0]]]


def ring():
    """A corridor of two metres round a block, with niches and pilasters at uneven distances."""
    walls = box(0, 0, 16, 10) + box(2, 2, 14, 8)
    for x, width in ((3.5, 0.5), (6.0, 0.3), (9.1, 0.6), (12.0, 0.4)):
        walls += box(x, 1.6, x + width, 2.0)
    for x, width in ((4.0, 0.4), (8.0, 0.7), (11.0, 0.3)):
        walls += box(x, 9.5, x + width, 10.0)
    for y in (3.0, 4.2, 6.5):
        walls += box(15.6, y, 16.0, y + 0.5)
    for y in (3.5, 6.2):
        walls += box(0.0, y, 0.35, y + 0.4)
    return LineWorld(np.array(walls))


def round_the_ring(laps=1.15, step_m=0.2):
    """True steps of a drive along the middle of the corridor."""
    corners, goal, pose, driven, steps = [(1, 1), (15, 1), (15, 9), (1, 9)], 1, Pose2(5.0, 1.0, 0.0), 0.0, []
    while driven < laps * 44.0:
        x, y = corners[goal][0] - pose.x_m, corners[goal][1] - pose.y_m
        if math.hypot(x, y) < 0.3:
            goal = (goal + 1) % 4
            continue
        off = angle_difference(math.atan2(y, x), pose.yaw_rad)
        step = Pose2(0.02, 0.0, float(np.clip(off, -0.3, 0.3))) if abs(off) > 0.15 else Pose2(step_m, 0.0, 0.5 * off)
        steps.append(step)
        pose = pose.compose(step)
        driven += step.x_m
    return steps


def drive(made, steps):
    """True poses by scan stamp, and placed ones; odometry is a fifth too long and misses 5 % of every turn."""
    world, generator, truth, odometry = ring(), np.random.default_rng(0), Pose2(5.0, 1.0, 0.0), HERE
    true, placed = [], []
    for index, step in enumerate([HERE, *steps]):
        truth = truth.compose(step)
        odometry = odometry.compose(Pose2(1.2 * step.x_m, 0.0, 0.95 * step.yaw_rad))
        scan = world.scan(truth, generator, beams=180, range_max_m=2.5, stamp_ns=index)
        placed.append(made.add(scan_points(scan, HERE), odometry))
        true.append(truth)
    return true, placed


def off_by(true, pose):
    begin = Pose2(5.0, 1.0, 0.0)
    away = begin.inverse().compose(true).inverse().compose(pose)
    return math.hypot(away.x_m, away.y_m)


needs_solver = pytest.mark.skipif(importlib.util.find_spec("gtsam") is None, reason="no GTSAM here")


@needs_solver
def test_a_ring_corridor_comes_back_to_where_it_began():
    steps = round_the_ring()
    made = LoopClosingMapper(MapperSettings(), LogOddsSettings(), MatchSettings())
    true, placed = drive(made, steps)
    assert made.closer.loops
    # Odometry alone ends ten metres off. With other noise of the scans this is 0.15 to 0.34 m.
    assert off_by(true[-1], placed[-1].pose) < 0.4
    errors = [off_by(true[scan.points.stamp_ns], scan.pose) for scan in made.closer.scans]
    assert np.mean(errors) < 0.3
    again = made.as_map()
    walls = again.centres_of(np.argwhere(again.occupancy > 65))
    assert (ring().distances(Pose2(5.0, 1.0, 0.0).transform(walls)) < 0.5).mean() > 0.9
    last = made.odom_in_map.compose(HERE)
    assert math.isfinite(last.x_m) and made.kept.refused == ""


def chain(count=40, radius_m=3.0, drift=0.002):
    """A circle driven once: drifting poses, their motions, and the loop from the first to the last."""
    turn = 2.0 * math.pi / count
    true_step = Pose2(radius_m * turn, 0.0, turn)
    step = Pose2(radius_m * turn, 0.0, turn + drift)
    poses = [HERE]
    for _ in range(count):
        poses.append(poses[-1].compose(step))
    motions = [Edge(index, index + 1, step, UNSURE) for index in range(count)]
    truth = [HERE]
    for _ in range(count):
        truth.append(truth[-1].compose(true_step))
    return poses, motions, truth


@needs_solver
def test_a_loop_takes_the_drift_out_of_the_whole_way():
    poses, motions, truth = chain()
    found = fitted(poses, motions, [Edge(0, len(poses) - 1, truth[-1], SURE)])
    assert max(math.hypot(a.x_m - b.x_m, a.y_m - b.y_m) for a, b in zip(found, truth, strict=True)) < 0.03
    assert math.hypot(poses[-1].x_m, poses[-1].y_m) > 0.2 and np.allclose(found[0].as_array(), 0.0)


@needs_solver
def test_a_wrong_loop_bends_nothing_and_is_seen_to_contradict():
    poses, motions, truth = chain()
    right, wrong = Edge(0, len(poses) - 1, truth[-1], SURE), Edge(3, 20, Pose2(0.0, 0.0, 0.0), SURE)
    found = fitted(poses, motions, [right, right, right, wrong])
    assert max(math.hypot(a.x_m - b.x_m, a.y_m - b.y_m) for a, b in zip(found, truth, strict=True)) < 0.1
    assert misfit(found, wrong) > 100.0 > LoopSettings().loop_chi_square > misfit(found, right)


@needs_solver
@pytest.mark.parametrize(
    "edge",
    [
        Edge(0, 99, HERE, SURE),
        Edge(2, 2, HERE, SURE),
        Edge(0, 3, Pose2(math.nan, 0.0, 0.0), SURE),
        Edge(0, 3, HERE, np.zeros((3, 3))),
    ],
    ids=["no such pose", "to itself", "not finite", "no information"],
)
def test_edges_that_cannot_be_used_are_refused_by_name(edge):
    poses, motions, _ = chain(5)
    with pytest.raises(ValueError, match=f"edge from {edge.start} to {edge.end}"):
        fitted(poses, motions, [edge])


def closer_on(world_of, places, **options):
    """A closer that was led along ``places``; the scan at each is of the world that ``world_of(index)`` gives."""
    closer = LoopCloser(LoopSettings(**options), LogOddsSettings(), MatchSettings())
    kept = []
    for index, place in enumerate(places):
        points = scan_points(world_of(index).scan(place, beams=120, stamp_ns=index), HERE)
        kept.append(closer.add(points, place, None))
    return closer, kept


NOTHING = LineWorld(np.array([[[500.0, 0.0], [500.0, 1.0]]]))


def there_and_back_again():
    """Poses along a room, on a way where nothing is to be seen, and along the room again."""
    out = [Pose2(-2.0 + 0.4 * index, 0.5, 0.0) for index in range(12)]
    return [*out, *[Pose2(2.4 - 0.4 * index, 3.0, 3.1) for index in range(12)], *out]


def test_a_place_that_looks_different_is_no_loop():
    one = LineWorld(np.array(box(-4, -3, 5, 5) + box(0, -2, 1, -1)))
    other = LineWorld(np.array(box(-4.9, -2.2, 5.6, 4.1) + box(2, 2, 3, 2.5)))
    closer, kept = closer_on(
        lambda index: (one, NOTHING, other)[index // 12], there_and_back_again(), loop_least_way_m=6.0
    )
    assert not closer.loops and not any(each.closed for each in kept)
    assert any("lies on the walls of that place" in reason for reason in closer.refused)


@needs_solver
def test_a_look_alike_that_contradicts_the_way_is_refused():
    """The same room twice, 1.6 m apart: the walls agree, the odometry does not."""
    one = LineWorld(np.array(box(-4, -3, 5, 5) + box(0, -2, 1, -1)))
    closer, kept = closer_on(
        lambda index: (one, NOTHING, LineWorld(one.walls + np.array([1.6, 0.0])))[index // 12],
        there_and_back_again(),
        loop_least_way_m=6.0,
        odometry_m_per_m=0.01,
    )
    before = there_and_back_again()
    assert not closer.loops and not any(each.closed for each in kept)
    assert closer.refused.get("the loop contradicts the way driven", 0) >= 1
    assert all(scan.pose == place for scan, place in zip(closer.scans, before, strict=False))


def test_along_a_bare_corridor_no_loop_is_claimed():
    walls = LineWorld(np.array([[[-40.0, -1.0], [40.0, -1.0]], [[-40.0, 1.0], [40.0, 1.0]]]))
    places = [Pose2(0.5 * index, 0.0, 0.0) for index in range(20)]
    back = [Pose2(9.5 - 0.5 * index, 0.2, 0.0) for index in range(20)]
    closer, _ = closer_on(lambda _: walls, places + back, loop_least_way_m=5.0)
    assert not closer.loops and closer.refused


def test_scans_without_a_single_return_close_nothing():
    empty = ScanPoints(0, np.zeros((0, 2)), np.zeros((0, 2)), (0.0, 0.0))
    closer = LoopCloser(LoopSettings(loop_least_way_m=2.0), LogOddsSettings(), MatchSettings())
    for index in range(30):
        angle = 0.4 * index
        closer.add(empty, Pose2(math.cos(angle), math.sin(angle), angle), None)
    assert not closer.loops and closer.refused == {"nothing was seen there": closer.refused["nothing was seen there"]}
