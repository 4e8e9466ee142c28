"""Pose of a scan on a map: Gauss-Newton on the points' distances across the nearest walls, with robust weights."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from tracked_localization.matching.wall_field import Walls
from tracked_types import Pose2, wrap_angle
from tracked_types.setting import check_settings, setting

Array = NDArray[np.float64]
_STEP_TOLERANCE = 5e-4  # m, and m at the lever of the turn
_LEAST_POINTS = 10


class WallsNearby(Protocol):
    """Whoever knows the nearest piece of wall to places: a map's field, or another scan."""

    def at(self, points: Array) -> Walls:
        """The nearest piece of wall to each of the ``points`` (n, 2)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MatchSettings:
    """What counts as agreement between a scan and a map."""

    match_reach_m: float = setting(
        0.5, "points farther than this from anything on the map say nothing", unit="m", low=0.01, high=10.0
    )
    match_scale_m: float = setting(0.05, "distance at which a point counts half", unit="m", low=0.001, high=1.0)
    match_iterations: int = setting(20, "most steps of one match", low=1, high=200)
    match_deviation_m: float = setting(
        0.01, "standard deviation that a point's distance has at least", unit="m", low=1e-4, high=1.0
    )
    match_agreement: float = setting(
        0.5, "share of a scan's points that must lie on the map for the match to count", low=0.0, high=1.0
    )
    match_observable: float = setting(
        0.02, "a direction counts as seen if it holds this share of what the points say", low=0.0, high=0.5
    )

    def __post_init__(self) -> None:
        check_settings(self)


@dataclass(frozen=True, slots=True)
class Match:
    """Where a scan lies on the map.

    pose: of the base in the map's frame. information: inverse covariance of x, y, yaw (3, 3) in the map's axes; zero
    along directions that the scan does not show, in which the pose stays as it was guessed. deviation_m: root of the
    weighted mean square distance. agreement: share of the points that lie on the map, each by its weight. seen: how
    many of the three directions the scan shows. converged: the last step was negligible.
    """

    pose: Pose2
    information: Array
    deviation_m: float
    agreement: float
    seen: int
    converged: bool

    def doubt(self, settings: MatchSettings) -> str:
        """Why the scan says nothing of where it is, in words; empty if it does."""
        if self.seen == 0:
            return "the scan shows nothing of the map"
        if self.agreement < settings.match_agreement:
            return f"only {self.agreement:.0%} of the scan lies on the map"
        return ""


def match_scan(field: WallsNearby, points: Array, guess: Pose2, settings: MatchSettings) -> Match:
    """Lay ``points`` (n, 2), given in the base's frame, over the map, beginning at ``guess``.

    Raises
    ------
    ValueError: if points or guess are not finite.
    """
    if not np.isfinite(points).all() or not np.isfinite(guess.as_array()).all():
        raise ValueError("points and guess must be finite")
    lever = max(float(np.sqrt(np.mean(np.sum(points**2, axis=1)))), 0.1) if len(points) else 1.0
    pose, converged = guess, False
    normal_equations = _NormalEquations(field, points, pose, lever, settings)
    for _ in range(settings.match_iterations):
        step = normal_equations.step()
        if step is None:
            break
        yaw_rad = wrap_angle(pose.yaw_rad + float(step[2]) / lever)
        pose = Pose2(pose.x_m + float(step[0]), pose.y_m + float(step[1]), yaw_rad)
        normal_equations = _NormalEquations(field, points, pose, lever, settings)
        if np.abs(step).max() < _STEP_TOLERANCE:
            converged = True
            break
    return normal_equations.judged(converged)


class _NormalEquations:
    """Least squares at one pose; the turn is measured at the lever, so that all three unknowns are metres."""

    def __init__(self, field: WallsNearby, points: Array, pose: Pose2, lever: float, settings: MatchSettings) -> None:
        self._settings, self._pose, self._lever, self._count = settings, pose, lever, len(points)
        placed = pose.transform(points)
        walls = field.at(placed)
        arm = placed - np.array([pose.x_m, pose.y_m])
        turning = (arm[:, 0] * walls.normal[:, 1] - arm[:, 1] * walls.normal[:, 0]) / lever
        jacobian = np.column_stack([walls.normal, turning])
        weights = (walls.distance_m < settings.match_reach_m) / (1.0 + (walls.offset_m / settings.match_scale_m) ** 2)
        self._total = float(weights.sum())
        self._usable = self._total >= _LEAST_POINTS
        self._gradient = jacobian.T @ (weights * walls.offset_m)
        self._square = float(weights @ walls.offset_m**2)
        shares, directions = np.linalg.eigh(jacobian.T @ (jacobian * weights[:, None]))
        seen = shares > settings.match_observable * max(self._total, 1.0)
        self._shares, self._directions = shares[seen], directions[:, seen]

    def step(self) -> Array | None:
        """Change of x (m), y (m) and turn (m at the lever) along the directions that are seen; None without any."""
        if not self._usable or not len(self._shares):
            return None
        along: Array = -self._directions @ ((self._directions.T @ self._gradient) / self._shares)
        return along

    def judged(self, converged: bool) -> Match:
        agreement = self._total / max(self._count, 1)
        if not self._usable:
            return Match(self._pose, np.zeros((3, 3)), float("inf"), agreement, 0, False)
        deviation = float(np.sqrt(self._square / self._total))
        noise = max(deviation, self._settings.match_deviation_m) ** 2
        scaling = np.array([1.0, 1.0, self._lever])
        kept = (self._directions * (self._shares / noise)) @ self._directions.T
        information: Array = kept * np.outer(scaling, scaling)
        return Match(self._pose, information, deviation, agreement, len(self._shares), converged)
