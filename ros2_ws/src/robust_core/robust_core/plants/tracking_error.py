"""The tracking error of a unicycle about a moving reference, (5.2.14), as a discrete polytopic model.

The error is taken in the frame of the reference: e = (ahead, left, heading), inputs are the differences of speed and
yaw rate from the reference's. With psi = e_3 + h T dw, h the point of the step where its heading is taken,

    (e_1, e_2)+ = Rot(-T w_d) (e_1, e_2) + T v_d sinc(psi / 2) (-sin b, cos b) psi + T dv (cos g, sin g)
    e_3+ = e_3 + T dw,      b = psi / 2 - (1 - h) T w_d,      g = psi - (1 - h) T w_d

is exact. While |w_d| and |psi| keep their bounds and v_d its range, each pair of cosine and sine stays in a trapezoid
with exact rational corners that circumscribes the arc, so the vertices enclose the error's motion beyond doubt.
"""

import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.checks import finite_number
from robust_core.errors import ArgumentError
from robust_core.models import PolytopicSystem
from robust_core.rational import Floats, rational


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackingError:
    """Step, range of the reference's speed, bounds on its yaw rate and on psi, point of the heading in [0, 1].

    The slowest speed must be positive: beside a reference at rest the error cannot be moved sideways, and no quadratic
    weight descends (the final approach is another controller's task).
    """

    period_s: float
    speed_mps: tuple[float, float]
    yaw_rate_radps: float
    heading_rad: float
    heading_point: float = 0.5

    def __post_init__(self) -> None:
        finite_number("period_s", self.period_s, low=0.0, open_low=True)
        finite_number("yaw_rate_radps", self.yaw_rate_radps, low=0.0)
        finite_number("heading_rad", self.heading_rad, low=0.0, high=1.5, open_low=True)
        finite_number("heading_point", self.heading_point, low=0.0, high=1.0)
        low = finite_number("speed_mps[0]", self.speed_mps[0])
        high = finite_number("speed_mps[1]", self.speed_mps[1])
        if not 0.0 < low <= high:
            raise ArgumentError(
                "speed_mps",
                "a range of positive speeds",
                f"{self.speed_mps}",
                "at rest or in reverse the error's model is another one; no terminal weight exists at rest",
            )
        if (1.0 - self.heading_point) * self.turn + self.heading_rad >= 1.5 or self.turn >= 1.5:
            raise ArgumentError("period_s", "short enough for turns below 1.5 rad a step", f"{self.period_s:g}")

    @property
    def turn(self) -> float:
        """Largest turn of the reference in a step (rad)."""
        return self.period_s * self.yaw_rate_radps

    def system(self) -> PolytopicSystem:
        """The vertices x+ = A_i x + B_i u: 96 of them, or fewer where the reference does not turn."""
        T, h = rational(self.period_s), rational(self.heading_point)
        rest = (1.0 - self.heading_point) * self.turn
        slow = rational(self.speed_mps[0]) * _sinc_below(0.5 * self.heading_rad)
        frames = _trapezoid(self.turn)
        moves = _sector(rest + 0.5 * self.heading_rad, slow, rational(self.speed_mps[1]))
        pushes = _trapezoid(rest + self.heading_rad)
        A, B = [], []
        for (c, s), (bc, bs), (gc, gs) in itertools.product(frames, moves, pushes):
            A.append([[c, s, -T * bs], [-s, c, T * bc], [0, 0, 1]])
            B.append([[T * gc, -h * T * T * bs], [T * gs, h * T * T * bc], [0, T]])
        return PolytopicSystem.of(np.array(A, dtype=object), np.array(B, dtype=object))

    def step(self, error: Floats, change: Floats, speed_mps: Any, yaw_rate_radps: Any) -> Floats:
        """The next error (..., 3) of the unicycle itself, for changes (..., 2) of speed and yaw rate."""
        T, h = self.period_s, self.heading_point
        v, w = speed_mps + change[..., 0], yaw_rate_radps + change[..., 1]
        along, reference = error[..., 2] + h * T * w, h * T * np.asarray(yaw_rate_radps)
        x = error[..., 0] + T * (v * np.cos(along) - speed_mps * np.cos(reference))
        y = error[..., 1] + T * (v * np.sin(along) - speed_mps * np.sin(reference))
        turn = T * np.asarray(yaw_rate_radps)
        cosine, sine = np.cos(turn), np.sin(turn)
        return np.stack([cosine * x + sine * y, -sine * x + cosine * y, error[..., 2] + T * change[..., 1]], axis=-1)


def _half_tangent(angle: float) -> Any:
    """An exact number just above tan(angle / 2); the arc it stands for holds the one asked for."""
    return rational(math.tan(0.5 * angle) * (1.0 + 1e-12))


def _trapezoid(angle: float) -> list[tuple[Any, Any]]:
    """Corners of a trapezoid that holds (cos a, sin a) for |a| <= angle: the arc's ends, and where its tangents there
    meet the one in the middle."""
    if angle == 0.0:
        return [(rational(1), rational(0))]
    t, one = _half_tangent(angle), rational(1)
    c, s = (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)
    return [(c, s), (c, -s), (one, t), (one, -t)]


def _sector(angle: float, low: Any, high: Any) -> list[tuple[Any, Any]]:
    """Corners of a polygon that holds r (cos a, sin a) for |a| <= angle, low <= r <= high."""
    outer = [(high * c, high * s) for c, s in _trapezoid(angle)]
    return outer + [(low * c, low * s) for c, s in _trapezoid(angle)[:2]]


def _sinc_below(angle: float) -> Any:
    """An exact number just below sin(angle) / angle."""
    return rational(math.sin(angle) / angle * (1.0 - 1e-12))
