import numpy as np
import pytest

from tracked_report.plots.bands import PlannedBand, bands_over_time
from tracked_types import Mover, Trajectory

CORNERS = np.array([[0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2], [0.3, -0.2]])


def band(now_s, kind="band"):
    times = np.linspace(0.0, 1.0, 5)
    states = np.column_stack([now_s + 0.4 * times, np.zeros(5), np.zeros(5)])
    mover = Mover(1, 0, "map", np.array([2.0, 1.0]), np.zeros(2), np.eye(4), 0.3)
    return PlannedBand(now_s, Trajectory(0, "map", times, states, np.zeros((5, 2))), kind, (mover,))


def test_bands_stops_movers_path_and_obstacles_are_drawn():
    drawn = [band(0.2 * index, "stop" if index == 3 else "band") for index in range(6)]
    svg = bands_over_time(drawn, "bands", corners=CORNERS, path=np.zeros((2, 3)), points=np.ones((4, 2)))
    assert svg.count("<path") > 10 and "#c81e1e" in svg and "6 bands" in svg


def test_updates_without_a_trajectory_are_left_out():
    assert "1 bands" in bands_over_time([band(0.0), PlannedBand(0.2, None, "none")], "bands", corners=CORNERS)


def test_nothing_to_draw_is_an_error():
    with pytest.raises(ValueError, match="no band"):
        bands_over_time([PlannedBand(0.0, None, "none")], "bands", corners=CORNERS)
