import math

import pytest

from tracked_types import Outline


def test_a_turned_box_has_its_corners_where_they_belong():
    corners = sorted(Outline.box(1.0, 2.0, 4.0, 2.0, yaw_rad=math.pi / 2).points)
    for corner, expected in zip(corners, [(0.0, 0.0), (0.0, 4.0), (2.0, 0.0), (2.0, 4.0)], strict=True):
        assert corner == pytest.approx(expected)


def test_a_circle_is_a_polygon_of_its_radius():
    points = Outline.circle(1.0, 2.0, 0.5).points
    assert [math.hypot(x - 1.0, y - 2.0) for x, y in points] == pytest.approx([0.5] * 36)
