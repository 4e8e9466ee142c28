"""Timed elastic band: a checked trajectory along the global path, around obstacles and movers."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tracked_navigation.band.band_check import BandCheck
from tracked_navigation.band.band_contest import BandContest, Outcome, Task
from tracked_navigation.band.band_memory import BandMemory
from tracked_navigation.band.band_result import ARRIVED, NONE, STOP, BandResult, Candidate
from tracked_navigation.band.braking import safest_stop
from tracked_navigation.band.optimizer import BandOptimizer
from tracked_navigation.band.rollout import as_trajectory
from tracked_navigation.band.route import Route, route_along
from tracked_navigation.band.settings import BandSettings
from tracked_navigation.band.surroundings import BadSurroundings, Surroundings
from tracked_types import Mover, Pose2, Trajectory, Twist2, wrap_angle

Array = NDArray[np.float64]
NO_SEGMENTS = np.zeros((0, 2, 2))
_END_ROOM_SHARE = 0.5  # of the wanted clearance, which the place has to have where a band ends
_STANDSTILL_MPS, _STANDSTILL_RADPS = 0.01, 0.02


class TimedElasticBand:
    """Plans anew at every update from where the robot is; what it hands out has been checked interval by interval.

    If the band that was followed may not be driven, one at half the speed is tried, then the other ways round, and
    if none of them may, the robot brakes to rest.
    """

    def __init__(self, settings: BandSettings, optimizer: BandOptimizer | None = None) -> None:
        self.settings = self._usual = settings
        self.check = BandCheck(settings.footprint, settings.limits, settings.least_clearance_m)
        self.optimizer = optimizer or BandOptimizer(settings)
        self._contest = BandContest(settings, self.optimizer, self.check)
        self._memory = BandMemory()

    def forget(self) -> None:
        """The clock or the robot has jumped: start anew."""
        self._memory.forget()

    def slow_to(self, speed_mps: float) -> None:
        """Plan no faster than this from now on; inf for the speed of the settings."""
        speed = min(speed_mps, self._usual.speed_mps)
        if speed != self.settings.speed_mps:
            self.settings = replace(self._usual, speed_mps=speed)
            self._contest.settings = self.optimizer.settings = self.settings
            self.optimizer.set_speed_limit(self.settings.cruise_mps)

    def update(
        self,
        start: Pose2,
        twist: Twist2,
        path: Array,
        obstacles: Array,
        movers: tuple[Mover, ...],
        stamp_ns: int,
        *,
        segments: Array = NO_SEGMENTS,
    ) -> BandResult:
        """A trajectory from the robot's state at ``stamp_ns`` on.

        start, twist: pose in ``frame_id`` and velocity of the robot. path: (n, 3) poses of the global plan, the goal
        last. obstacles: points (m, 2); segments: (s, 2, 2) their ends. Input that makes no sense stops the robot, with
        the reason in the result.
        """
        if not np.isfinite([start.x_m, start.y_m, start.yaw_rad, twist.speed_mps, twist.yaw_rate_radps]).all():
            self.forget()
            return BandResult(None, NONE, "the robot's pose or velocity is not finite")
        problem = _path_problem(path)
        if problem:
            return self._stop(start, twist, Surroundings.none(), stamp_ns, problem)
        try:
            surroundings = Surroundings.of(
                obstacles, segments, movers, stamp_ns=stamp_ns, frame_id=self.settings.frame_id
            )
        except BadSurroundings as error:
            return self._stop(start, twist, Surroundings.none(), stamp_ns, str(error))
        return self._planned(start, twist, path, surroundings, stamp_ns)

    def _planned(
        self, start: Pose2, twist: Twist2, path: Array, surroundings: Surroundings, stamp_ns: int
    ) -> BandResult:
        settings = self.settings
        if self._is_at(path[-1], start, twist):
            result = self._stop(start, twist, surroundings, stamp_ns, "")
            return BandResult(result.trajectory, ARRIVED, "", clearance_m=result.clearance_m)
        room = max(_END_ROOM_SHARE * settings.clearance_m, settings.least_clearance_m)
        route = route_along(path, start, settings.lookahead_m, surroundings, settings.footprint, room)
        if route is None:
            return self._stop(start, twist, surroundings, stamp_ns, "no place ahead on the path is free")
        if route.rests and self._is_at(route.end, start, twist):
            return self._stop(start, twist, surroundings, stamp_ns, route.reason)
        followed = self._memory.carried_on(start, twist, route, stamp_ns)
        outcome = self._contest.decide(Task(start, twist, route, surroundings), followed)
        if outcome.chosen is None:
            return self._stop(start, twist, surroundings, stamp_ns, outcome.reason, outcome.candidates)
        if outcome.kind == STOP:
            self._memory.forget()  # a band that may not be driven to its end has no claim to be followed
        else:
            self._memory.keep(outcome.chosen.nodes, stamp_ns)
        return self._handed_out(outcome, route, stamp_ns)

    def _handed_out(self, outcome: Outcome, route: Route, stamp_ns: int) -> BandResult:
        chosen = outcome.chosen
        assert chosen is not None
        trajectory = as_trajectory(stamp_ns, self.settings.frame_id, *chosen.samples)
        reason = "; ".join(filter(None, (outcome.reason, route.reason)))
        return BandResult(
            trajectory, outcome.kind, reason, chosen.way, chosen.finding.clearance_m, candidates=outcome.candidates
        )

    def _stop(
        self,
        start: Pose2,
        twist: Twist2,
        surroundings: Surroundings,
        stamp_ns: int,
        reason: str,
        candidates: tuple[Candidate, ...] = (),
    ) -> BandResult:
        self._memory.forget()
        way, finding = safest_stop(start, twist, self.check, surroundings)
        trajectory: Trajectory = as_trajectory(stamp_ns, self.settings.frame_id, *way)
        return BandResult(
            trajectory,
            STOP,
            reason,
            clearance_m=finding.clearance_m,
            unavoidable=np.isfinite(finding.contact_s),
            candidates=candidates,
        )

    def _is_at(self, goal: Array, start: Pose2, twist: Twist2) -> bool:
        settings = self.settings
        return bool(
            np.hypot(goal[0] - start.x_m, goal[1] - start.y_m) <= settings.goal_tolerance_m
            and abs(wrap_angle(float(goal[2]) - start.yaw_rad)) <= settings.goal_tolerance_rad
            and abs(twist.speed_mps) <= _STANDSTILL_MPS
            and abs(twist.yaw_rate_radps) <= _STANDSTILL_RADPS
        )


def _path_problem(path: Array) -> str:
    """What is wrong with a path, in words; empty if nothing."""
    array = np.asarray(path)
    if array.ndim != 2 or array.shape[1:] != (3,):
        return f"the path must have shape (n, 3), got {array.shape}"
    if not len(array):
        return "the path is empty"
    if not np.isfinite(array).all():
        return "the path holds a value that is not finite"
    return ""
