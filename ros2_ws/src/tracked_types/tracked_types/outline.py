"""Shapes on the floor, seen from above."""

import math
from dataclasses import dataclass
from typing import Literal

OutlineKind = Literal["wall", "obstacle", "step", "ramp", "friction", "movable"]


@dataclass(frozen=True, slots=True)
class Outline:
    """Closed polygon on the floor: corners (m) in the world frame, what it is, and its height (m)."""

    points: tuple[tuple[float, float], ...]
    kind: OutlineKind = "obstacle"
    label: str = ""
    height_m: float = 0.0

    @classmethod
    def box(
        cls,
        x_m: float,
        y_m: float,
        length_m: float,
        width_m: float,
        *,
        yaw_rad: float = 0.0,
        kind: OutlineKind = "obstacle",
        label: str = "",
        height_m: float = 0.0,
    ) -> "Outline":
        """Rectangle about a centre: ``length_m`` along its own x, turned by ``yaw_rad``."""
        cosine, sine = math.cos(yaw_rad), math.sin(yaw_rad)
        corners = [(sx * length_m / 2.0, sy * width_m / 2.0) for sx, sy in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
        points = tuple((x_m + cosine * u - sine * v, y_m + sine * u + cosine * v) for u, v in corners)
        return cls(points, kind, label, height_m)

    @classmethod
    def circle(
        cls,
        x_m: float,
        y_m: float,
        radius_m: float,
        *,
        kind: OutlineKind = "obstacle",
        label: str = "",
        height_m: float = 0.0,
    ) -> "Outline":
        """Circle, as a polygon of 36 corners."""
        angles = [math.tau * index / 36.0 for index in range(36)]
        points = tuple((x_m + radius_m * math.cos(a), y_m + radius_m * math.sin(a)) for a in angles)
        return cls(points, kind, label, height_m)
