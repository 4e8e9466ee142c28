import heapq
import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tracked_description import load_robot
from tracked_navigation.planning.costmap import CostSettings, make_costmap
from tracked_navigation.planning.grid_planner import GridPlanner
from tracked_navigation.planning.path_smoothing import line_cost, smooth_path
from tracked_navigation.planning.zones import Zones, load_zones
from tracked_types import OccupancyMap, Pose2
from tracked_types.checked_yaml import CheckedFileError

SETTINGS = CostSettings.from_robot(load_robot())
RESOLUTION = 0.05


def room(width=100, height=80, walls=(), origin=Pose2(-1.0, -2.0, 0.0)):  # noqa: B008
    """A free room; ``walls`` are (row, row, column, column) windows."""
    occupancy = np.zeros((height, width), np.int8)
    occupancy[[0, -1]] = occupancy[:, [0, -1]] = 100
    for top, bottom, left, right in walls:
        occupancy[top:bottom, left:right] = 100
    return OccupancyMap("map", RESOLUTION, origin, occupancy)


def planner_on(costmap):
    planner = GridPlanner()
    planner.set_costmap(costmap)
    return planner


def place(costmap, row, column):
    x, y = costmap.map.centres_of(np.array([[row, column]]))[0]
    return Pose2(float(x), float(y), 0.0)


def cheapest(cost, first, last):
    """Textbook search, for comparison."""
    best, queue = {first: 0.0}, [(0.0, first)]
    while queue:
        spent, cell = heapq.heappop(queue)
        if cell == last:
            return spent * RESOLUTION
        if spent > best[cell]:
            continue
        for up in (-1, 0, 1):
            for across in (-1, 0, 1):
                there = (cell[0] + up, cell[1] + across)
                if (up or across) and 0 <= there[0] < cost.shape[0] and 0 <= there[1] < cost.shape[1]:
                    total = spent + np.hypot(up, across) * 0.5 * (cost[cell] + cost[there])
                    if total < best.get(there, np.inf):
                        best[there] = total
                        heapq.heappush(queue, (total, there))
    return np.inf


walls_strategy = st.lists(
    st.tuples(st.integers(0, 39), st.integers(0, 49), st.integers(1, 14), st.integers(1, 14)), max_size=5
)


@settings(max_examples=30, deadline=None)
@given(walls=walls_strategy, ends=st.tuples(*[st.integers(0, 39), st.integers(0, 49)] * 2))
def test_a_plan_is_the_cheapest_there_is_or_says_why_there_is_none(walls, ends):
    occupied = [(top, top + high, left, left + wide) for top, left, high, wide in walls]
    costmap = make_costmap(room(50, 40, occupied), SETTINGS)
    first, last = ends[:2], ends[2:]
    plan = planner_on(costmap).plan(place(costmap, *first), place(costmap, *last))
    if plan.points is None:
        assert plan.reason
        assert plan.nearest is None or np.isfinite(costmap.at(np.array([plan.nearest])))[0]
    elif np.isfinite(costmap.cost[first]):
        assert plan.cost == pytest.approx(cheapest(costmap.cost, first, last))
        assert np.isfinite(costmap.at(plan.points)).all()


@settings(max_examples=20, deadline=None)
@given(first=walls_strategy, second=walls_strategy)
def test_a_planner_that_was_used_before_plans_as_a_new_one(first, second):
    maps = [
        make_costmap(room(50, 40, [(top, top + high, left, left + wide) for top, left, high, wide in walls]), SETTINGS)
        for walls in (first, second)
    ]
    used = planner_on(maps[0])
    used.set_costmap(maps[1])
    start, goal = place(maps[1], 8, 8), place(maps[1], 30, 40)
    assert used.plan(start, goal).cost == planner_on(maps[1]).plan(start, goal).cost


@settings(max_examples=30, deadline=None)
@given(walls=walls_strategy)
def test_a_smoothed_path_costs_no_more_and_stays_clear(walls):
    costmap = make_costmap(
        room(50, 40, [(top, top + high, left, left + wide) for top, left, high, wide in walls]), SETTINGS
    )
    start, goal = place(costmap, 8, 8), Pose2(*place(costmap, 30, 40).as_array()[:2], 1.2)
    plan = planner_on(costmap).plan(start, goal)
    if plan.points is None or not np.isfinite(costmap.at(plan.points)).all():
        return
    path = smooth_path(costmap, plan.points, goal)
    assert np.isfinite(costmap.at(path[:, :2])).all()
    assert path[0, :2] == pytest.approx([start.x_m, start.y_m])
    assert path[-1] == pytest.approx([goal.x_m, goal.y_m, 1.2])
    smooth, stepped = (
        sum(line_cost(costmap, *ends) for ends in itertools.pairwise(points)) for points in (path[:, :2], plan.points)
    )
    assert smooth <= 1.02 * stepped


def test_a_straight_way_through_a_free_room_becomes_a_straight_line():
    costmap = make_costmap(room(), SETTINGS)
    start, goal = Pose2(0.0, -1.0, 0.0), Pose2(3.0, 0.5, 0.0)
    path = smooth_path(costmap, planner_on(costmap).plan(start, goal).points, goal)
    assert np.ptp(path[:-1, 2]) < 0.05
    assert np.hypot(*np.diff(path[:, :2], axis=0).T).sum() == pytest.approx(np.hypot(3.0, 1.5), rel=0.01)


def test_a_goal_in_a_wall_or_behind_one_is_refused_with_the_nearest_place():
    costmap = make_costmap(room(walls=[(0, 80, 50, 52)]), SETTINGS)
    planner, start = planner_on(costmap), Pose2(0.0, 0.0, 0.0)
    inside = planner.plan(start, Pose2(1.55, 0.0, 0.0))
    behind = planner.plan(start, Pose2(3.0, 0.0, 0.0))
    outside = planner.plan(start, Pose2(30.0, 0.0, 0.0))
    assert "obstacle" in inside.reason and "no way" in behind.reason and "outside" in outside.reason
    for refused in (inside, behind, outside):
        assert refused.nearest[0] == pytest.approx(1.5 - SETTINGS.inscribed_m - SETTINGS.margin_m, abs=0.06)


def test_a_robot_that_stands_against_a_wall_finds_its_way_off_it():
    costmap = make_costmap(room(), SETTINGS)
    plan = planner_on(costmap).plan(Pose2(-0.9, 0.0, 0.0), Pose2(3.0, 0.0, 0.0))
    assert plan.points is not None and np.isfinite(costmap.at(plan.points[1:])).all()


def test_obstacles_that_are_not_on_the_map_are_gone_round():
    box = np.stack(np.meshgrid(np.arange(0.9, 1.1, 0.02), np.arange(-0.2, 0.2, 0.02)), -1).reshape(-1, 2)
    costmap = make_costmap(room(), SETTINGS, box)
    plan = planner_on(costmap).plan(Pose2(0.0, 0.0, 0.0), Pose2(2.5, 0.0, 0.0))
    gaps = np.linalg.norm(plan.points[:, None] - box[None], axis=2).min()
    assert gaps > SETTINGS.inscribed_m
    assert make_costmap(room(), SETTINGS, np.array([[1e9, 0.0]])).cost == pytest.approx(
        make_costmap(room(), SETTINGS).cost
    )


def test_a_forbidden_zone_is_gone_round_a_slow_one_costs_more_and_a_preferred_one_draws():
    base = make_costmap(room(), SETTINGS)
    ways = {}
    for kind in ("forbidden", "slow", "preferred"):
        low, left, right = (-0.5, 0.8, 1.4) if kind != "preferred" else (0.8, 0.2, 2.3)
        corners = [[left, low], [right, low], [right, low + 1.0], [left, low + 1.0]]
        zone = {"name": "z", "kind": kind, "corners": corners, "cost": 3.0}
        costmap = Zones.model_validate({"zones": [zone]}).applied_to(base)
        ways[kind] = planner_on(costmap).plan(Pose2(0.0, 0.0, 0.0), Pose2(2.5, 0.0, 0.0))
    plain = planner_on(base).plan(Pose2(0.0, 0.0, 0.0), Pose2(2.5, 0.0, 0.0))
    assert np.abs(ways["forbidden"].points[:, 1]).max() > 0.45
    assert plain.cost < ways["slow"].cost < 3.0 * plain.cost
    assert ways["preferred"].points[:, 1].max() > 0.8


def test_the_lowest_speed_of_the_zones_around_a_place_counts():
    corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
    zones = Zones.model_validate(
        {"zones": [{"name": f"z{v}", "kind": "slow", "corners": corners, "speed_mps": v} for v in (0.3, 0.1)]}
    )
    assert zones.speed_limit_at(0.5, 0.5) == 0.1 and zones.speed_limit_at(2.0, 0.5) == np.inf


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("zones: [{name: a, kind: lava, corners: [[0, 0], [1, 0], [1, 1]]}]", "kind"),
        ("zones: [{name: a, kind: slow, corners: [[0, 0], [1, 0]]}]", "corners"),
        ("zones: [{name: a, kind: slow, corners: [[0, 0], [1, 0], [.nan, 1]]}]", "corners"),
        ("zones: [{name: a, kind: slow, corners: [[0, 0], [1, 0], [1, 1]], speed_mps: 0}]", "speed_mps"),
    ],
)
def test_zones_that_mean_nothing_are_refused_by_name(tmp_path, text, word):
    file = tmp_path / "zones.yaml"
    file.write_text(text)
    with pytest.raises(CheckedFileError, match=word):
        load_zones(file)


def test_a_map_without_a_free_place_or_a_robot_outside_is_said():
    full = make_costmap(OccupancyMap("map", 0.1, Pose2(0.0, 0.0, 0.0), np.full((9, 9), 100, np.int8)), SETTINGS)
    assert "free" in planner_on(full).plan(Pose2(0.5, 0.5, 0.0), Pose2(0.5, 0.5, 0.0)).reason
    costmap = make_costmap(room(), SETTINGS)
    assert "robot is outside" in planner_on(costmap).plan(Pose2(99.0, 0.0, 0.0), Pose2(0.0, 0.0, 0.0)).reason
    with pytest.raises(ValueError, match="finite"):
        planner_on(costmap).plan(Pose2(np.nan, 0.0, 0.0), Pose2(0.0, 0.0, 0.0))
    with pytest.raises(RuntimeError, match="set_costmap"):
        GridPlanner().plan(Pose2(0.0, 0.0, 0.0), Pose2(0.0, 0.0, 0.0))
