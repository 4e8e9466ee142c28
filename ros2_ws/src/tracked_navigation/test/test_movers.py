import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tracked_navigation.movers.clusters import clusters_of
from tracked_navigation.movers.map_mask import MapMask
from tracked_navigation.movers.mover_tracker import MoverSettings, MoverTracker
from tracked_types import OccupancyMap, Pose2

PERIOD_NS = 10**8


def face(centre, generator=None, radius=0.2, beams=9):
    """Points of a round body as a lidar at the origin sees them, in the order of its beams."""
    towards = np.arctan2(-centre[1], -centre[0])
    angles = towards + np.linspace(1.2, -1.2, beams)
    points = np.asarray(centre) + radius * np.column_stack([np.cos(angles), np.sin(angles)])
    return points if generator is None else points + 0.004 * generator.standard_normal(points.shape)


def tracker(**options):
    return MoverTracker(MoverSettings(**options), "map")


def walk(made, ways, seconds, seed=0, hidden=()):
    """Told movers after each scan; ``ways`` are (start, velocity)."""
    generator, told = np.random.default_rng(seed), []
    for index in range(round(10 * seconds)):
        bodies = [np.array(start) + 0.1 * index * np.array(velocity) for start, velocity in ways]
        seen = [face(body, generator) for body in bodies if index not in hidden]
        points = np.concatenate(seen) if seen else np.zeros((0, 2))
        told.append(made.update(points, (index + 1) * PERIOD_NS))
    return told


def test_a_person_who_walks_is_followed_with_speed_and_one_number():
    told = walk(tracker(), [((3.0, -1.0), (0.0, 0.6))], 3.0)
    (mover,) = told[-1]
    assert mover.velocity_mps == pytest.approx([0.0, 0.6], abs=0.12)
    assert mover.position_m == pytest.approx([2.9, 0.74], abs=0.15)
    assert {found.identity for scan in told for found in scan} == {mover.identity}
    assert any(told[:8]), "known within 0.8 s"


def test_what_stands_is_no_mover():
    told = walk(tracker(), [((2.0, 0.5), (0.0, 0.0)), ((1.0, -2.0), (0.0, 0.0))], 5.0)
    assert not any(told)


def test_a_mover_that_stops_is_still_one_without_speed():
    made = tracker()
    walk(made, [((3.0, -1.0), (0.0, 0.6))], 2.0)
    generator = np.random.default_rng(1)
    for index in range(20, 45):
        told = made.update(face((3.0, 0.2), generator), (index + 1) * PERIOD_NS)
    assert np.hypot(*told[0].velocity_mps) < 0.1


def test_a_mover_out_of_sight_is_predicted_for_a_second_and_keeps_its_number():
    made = tracker()
    told = walk(made, [((3.0, -2.0), (0.0, 0.6))], 4.0, hidden=range(20, 28))
    assert all(len(scan) == 1 for scan in told[15:])
    assert len({scan[0].identity for scan in told[15:]}) == 1
    assert told[27][0].covariance[1, 1] > told[19][0].covariance[1, 1]


def test_two_who_cross_keep_their_numbers():
    ways = [((2.0, -1.5), (0.0, 0.7)), ((3.2, 1.5), (0.0, -0.7))]
    told = walk(tracker(), ways, 4.0)
    first = {mover.identity: np.sign(mover.velocity_mps[1]) for mover in told[12]}
    last = {mover.identity: np.sign(mover.velocity_mps[1]) for mover in told[-1]}
    assert first == last and sorted(first.values()) == [-1.0, 1.0]


def test_a_long_wall_that_is_not_on_the_map_is_no_mover():
    wall = np.column_stack([np.full(60, 2.0), np.linspace(-1.5, 1.5, 60)])
    assert clusters_of(wall, gap_m=0.25, least_points=3, largest_m=1.2) == ()


def test_a_thing_across_the_seam_of_the_revolution_is_one_thing():
    body = face((-2.0, 0.0))
    order = np.roll(np.arange(len(body)), 4)
    (cluster,) = clusters_of(body[order], gap_m=0.25, least_points=3, largest_m=1.2)
    assert len(cluster.points_m) == len(body)


def test_a_clock_that_jumps_back_starts_over():
    made = tracker()
    walk(made, [((3.0, -1.0), (0.0, 0.6))], 2.0)
    assert made.update(face((3.0, 0.0)), PERIOD_NS) == ()


def test_points_that_are_not_finite_are_refused():
    with pytest.raises(ValueError, match="finite"):
        tracker().update(np.array([[np.nan, 0.0]]), 1)


@settings(max_examples=30, deadline=None)
@given(st.lists(st.lists(st.tuples(st.floats(-50, 50), st.floats(-50, 50)), max_size=30), max_size=12))
def test_any_points_leave_finite_movers_with_proper_covariances(scans):
    made = tracker(confirmations=1)
    for index, points in enumerate(scans):
        for mover in made.update(np.array(points).reshape(-1, 2), (index + 1) * PERIOD_NS):
            assert np.isfinite(mover.position_m).all() and np.hypot(*mover.velocity_mps) <= 2.5 + 1e-9
            assert np.linalg.eigvalsh(mover.covariance).min() > 0.0


def test_the_map_explains_its_walls_and_what_it_has_never_seen():
    occupancy = np.zeros((20, 20), np.int8)
    occupancy[:, 10] = 100
    occupancy[:, 15:] = -1
    mask = MapMask(OccupancyMap("map", 0.1, Pose2(0.0, 0.0, 0.0), occupancy), reach_m=0.15)
    points = np.array([[1.05, 1.0], [1.19, 1.0], [0.5, 1.0], [1.7, 1.0], [-3.0, 1.0], [9.0, 9.0]])
    assert mask.unexplained(points).tolist() == [False, False, True, False, False, False]
    everything = MapMask(OccupancyMap("map", 0.1, Pose2(0.0, 0.0, 0.0), np.zeros((20, 20), np.int8)), reach_m=0.15)
    assert everything.unexplained(points).tolist() == [True, True, True, True, False, False]
