import pytest

from sim_bridge.simulator import Simulator
from sim_bridge.walkers import Walker
from sim_bridge.world import load_world
from tracked_description import load_robot

WALKER = {"name": "visitor", "waypoints_m": ((2.0, -1.0), (2.0, 1.0)), "speed_mps": 0.5, "begins_s": 1.0}


def test_walker_waits_goes_there_and_comes_back():
    walker = Walker(**WALKER)
    places = [walker.place_m(time_s) for time_s in (0.0, 1.0, 3.0, 5.0, 7.0, 9.0)]
    assert places == [pytest.approx((2.0, y)) for y in (-1.0, -1.0, 0.0, 1.0, 0.0, -1.0)]


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"waypoints_m": ((1.0, 1.0), (1.0, 1.0))}, "lead nowhere"),
        ({"waypoints_m": ((1.0, 1.0),)}, "at least 2"),
        ({"speed_mps": 0.0}, "greater than 0"),
        ({"speed_mps": float("nan")}, "speed_mps"),
        ({"begins_s": -1.0}, "begins_s"),
    ],
)
def test_walker_that_makes_no_sense_is_refused(change, complaint):
    with pytest.raises(ValueError, match=complaint):
        Walker(**(WALKER | change))


def test_lidar_sees_the_walker_where_it_is_and_a_deleted_one_is_gone():
    world = load_world("flat").model_copy(update={"walkers": (Walker(**WALKER),)})
    simulator = Simulator(load_robot(), world)
    try:
        nearest = {}
        while simulator.stamp_ns < 3_300_000_000:
            for scan in simulator.advance().scans:
                nearest[scan.stamp_ns * 1e-9] = float(scan.ranges_m.min())
        early = [ranged for time_s, ranged in nearest.items() if time_s < 0.9]
        late = [ranged for time_s, ranged in nearest.items() if 2.9 < time_s < 3.1]
        assert min(early) > max(late) + 0.2
        simulator.vehicle.entities.delete("visitor")
        simulator.advance()
    finally:
        simulator.close()
