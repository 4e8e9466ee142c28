"""Drives to goals on a map, one band after another."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tracked_navigation.band import BandResult, TimedElasticBand
from tracked_navigation.band.band_result import STOP
from tracked_navigation.movers.mover_tracker import MoverSettings
from tracked_navigation.navigator.arrival import Arrival, Verdict, errors, rests
from tracked_navigation.navigator.escape import Escape
from tracked_navigation.navigator.global_path import GlobalPath, PathAnswer
from tracked_navigation.navigator.pieces import braked, in_frame, standing
from tracked_navigation.navigator.progress import Finished, NavigatorOutput, Outcome, Progress
from tracked_navigation.navigator.request import Request
from tracked_navigation.navigator.settings import NavigatorSettings
from tracked_navigation.navigator.tether import tethered
from tracked_navigation.navigator.view import View
from tracked_navigation.planning.costmap import CostSettings
from tracked_navigation.planning.zones import Zones
from tracked_types import (
    Mover,
    OccupancyMap,
    Odometry,
    PeriodGrid,
    Pose2,
    ScanPoints,
    StampOrder,
    Trajectory,
    Twist2,
    seconds_between,
)

Array = NDArray[np.float64]
_HUGE = 1e5  # m, rad, m/s, rad/s: no robot is there, or so fast
_JUMP_M, _JUMP_RAD = 0.25, 0.15  # of the odometry's frame in the map, beyond which the robot was somewhere else


class Navigator:
    """Takes a map, goals, scans and odometry; gives references to drive and says why it waits or gives up.

    Everything is decided at the instants of a grid on the stamps of the odometry. A goal pre-empts the one before.
    """

    def __init__(
        self,
        settings: NavigatorSettings,
        band: TimedElasticBand,
        costs: CostSettings,
        movers: MoverSettings,
        zones: Zones | None = None,
    ) -> None:
        self.settings, self.band = settings, band
        self._costs, self._movers, self._zones = costs, movers, zones or Zones()
        self._grid, self._order = PeriodGrid(settings.rate_hz), StampOrder()
        self._view: View | None = None
        self._path: GlobalPath | None = None
        self._request: Request | None = None
        self._escape = Escape()
        self._ended: Finished | None = None
        self._brakes = False
        self._odom_in_map: Pose2 | None = None

    def set_map(self, occupancy_map: OccupancyMap) -> None:
        """Drive on this map from now on; a request goes on, on a path of the new map."""
        settings, frame_id = self.settings, self.band.settings.frame_id
        self._view = View(occupancy_map, self._movers, frame_id, settings.remember_s)
        self._path = GlobalPath(occupancy_map, self._costs, self._zones, settings.replan_gain)
        self._start_anew()

    def go(self, goals: Sequence[Pose2]) -> None:
        """Drive past the ``goals``, poses in the map's frame, and stop at the last one.

        Raises
        ------
        ValueError: if there is no map yet, no goal, or a goal is not finite.
        """
        if self._path is None:
            raise ValueError("there is no map yet")
        if not goals:
            raise ValueError("there is no goal")
        for number, goal in enumerate(goals, start=1):
            if not np.isfinite(goal.as_array()).all():
                raise ValueError(f"goal {number} of {len(goals)} is not finite: {goal}")
        self._request = Request(self.settings, list(goals), Arrival(self.settings))
        self._path.forget()
        self._start_anew()

    def cancel(self) -> None:
        """Brake to rest and forget the goals; the next update says so."""
        if self._request is not None:
            self._end(Finished(self._order.latest_ns or 0, Outcome.CANCELLED, "cancelled"))

    @property
    def busy(self) -> bool:
        """Whether there is a goal."""
        return self._request is not None

    def see(self, points: ScanPoints, pose: Pose2) -> None:
        """Take in one scan; ``pose`` is that of the base in the map's frame at its stamp."""
        if self._view is not None:
            self._view.add(points, pose)

    def update(self, odometry: Odometry, odom_in_map: Pose2 | None) -> NavigatorOutput | None:
        """React to one odometry; None between the instants of the grid.

        ``odom_in_map`` is the pose of the odometry's frame in the map's, None if the robot does not know where it is.
        """
        if self._order.jumps_back(odometry.stamp_ns):
            if self._request is not None:
                self._end(Finished(odometry.stamp_ns, Outcome.ABORTED, "the clock was set back"))
            if self._view is not None:
                self._view.forget()
        if not self._order.advance(odometry.stamp_ns):
            return None
        if not self._grid.crossed(self._order.previous_ns, odometry.stamp_ns):
            return None
        return self._react(odometry, odom_in_map)

    def _react(self, odometry: Odometry, odom_in_map: Pose2 | None) -> NavigatorOutput:
        stamp_ns, limits = odometry.stamp_ns, self.band.settings.limits
        self._note_jump(odom_in_map)
        hindrance = self._hindrance(odometry, odom_in_map)
        output: NavigatorOutput | None = None
        if self._request is not None:
            if hindrance or odom_in_map is None:
                self._wait(self._request, hindrance, stamp_ns)
            else:
                output = self._drive(self._request, odometry, odom_in_map)
        movers = self._movers_now
        if self._ended is not None:
            ended, self._ended = self._ended, None
            self._brakes = output is None
            reference = output.reference if output is not None else braked(odometry, limits)
            return NavigatorOutput(stamp_ns, reference, movers=movers, finished=replace(ended, stamp_ns=stamp_ns))
        if self._request is None:
            return NavigatorOutput(stamp_ns, self._to_rest(odometry), movers=movers)
        if output is None:
            pose = odometry.pose if odom_in_map is None else odom_in_map.compose(odometry.pose)
            progress = self._progress(self._request, pose, stamp_ns)
            return NavigatorOutput(stamp_ns, braked(odometry, limits), movers=movers, progress=progress)
        return output

    def _to_rest(self, odometry: Odometry) -> Trajectory | None:
        """Without a request: brake from where the robot is, instant by instant, and in the end stand where it stands.

        Whoever follows would otherwise drive back to where the first braking would have ended.
        """
        if not self._brakes:
            return None
        self._brakes = not rests(odometry.twist, self.settings)
        if self._brakes:
            return braked(odometry, self.band.settings.limits)
        return standing(odometry.pose, odometry.stamp_ns, odometry.frame_id)

    def _drive(self, request: Request, odometry: Odometry, odom_in_map: Pose2) -> NavigatorOutput | None:
        """Along the path; None if the robot is to stand."""
        assert self._path is not None and self._view is not None
        stamp_ns, pose, map_in_odom = odometry.stamp_ns, odom_in_map.compose(odometry.pose), odom_in_map.inverse()
        request.begin(stamp_ns)
        self._path.follow(pose)
        while len(request.goals) > 1 and self._passes(request.goals[0], pose):
            del request.goals[0]
            request.looked_ns = None
        answer = self._look(request, pose, stamp_ns)
        if answer is None:
            return None
        band, settings = None, self.band.settings
        landed = request.arrival.update(request.goals[-1], request.followed, pose, odometry.twist, stamp_ns)
        if landed is Verdict.AGAIN:
            self._start_anew()
            return None
        if landed is not None:
            reference = self._land(request, landed, odometry, map_in_odom, pose)
        elif way := self._escape.way(pose, settings.footprint, self._view, stamp_ns, settings.frame_id):
            request.waits = "backs off from what touches it"
            reference = in_frame(way, odometry.frame_id, map_in_odom, from_ns=stamp_ns)
        else:
            band = self._band(request, pose, odometry.twist, stamp_ns)
            if self._request is None:
                return None  # given up: not on along the band
            assert band.trajectory is not None
            reference = in_frame(band.trajectory, odometry.frame_id, map_in_odom)
        path = self._path.ahead if answer.changed else None
        progress = self._progress(request, pose, stamp_ns)
        return NavigatorOutput(stamp_ns, reference, band, path, self._view.movers, progress)

    def _band(self, request: Request, pose: Pose2, twist: Twist2, stamp_ns: int) -> BandResult:
        assert self._path is not None and self._view is not None
        settings, band = self.settings, self.band
        ahead = self._path.ahead
        band.slow_to(self._zones.speed_limit_along(ahead, band.settings.lookahead_m))
        begin, moving = tethered(
            request.followed,
            pose,
            twist,
            stamp_ns,
            band.settings.limits,
            length_m=settings.tether_m,
            turn_rad=settings.tether_rad,
        )
        obstacles = self._view.obstacles_around(pose, settings.view_m)
        result = band.update(begin, moving, ahead, obstacles, self._view.movers, stamp_ns)
        stops = result.kind == STOP
        request.waits, request.followed = result.reason, None if stops else result.trajectory
        self._escape.note(touched=stops and result.unavoidable)
        request.note_left(self._path.left_m, stamp_ns)
        self._give_up_if_stuck(request, stamp_ns)
        return result

    def _look(self, request: Request, pose: Pose2, stamp_ns: int) -> PathAnswer | None:
        """Plan where that is due; None if there is no path."""
        assert self._path is not None and self._view is not None
        had_path = len(self._path.ahead) > 0
        since_s = None if request.looked_ns is None else seconds_between(stamp_ns, request.looked_ns)
        due = since_s is None or since_s >= self.settings.replan_period_s
        if had_path and (not due or request.arrival.landing):
            return PathAnswer()
        answer = self._path.look(pose, request.goals, self._view.unmapped)
        request.looked_ns = stamp_ns
        if answer.reason and answer.by_map:
            self._end(Finished(stamp_ns, Outcome.ABORTED, answer.reason, answer.nearest))
        elif answer.reason:
            self._wait(request, answer.reason, stamp_ns)
        if answer.reason:
            return None
        if answer.changed:
            request.take_path(self._path.left_m, instead=had_path)
        return answer

    def _land(
        self, request: Request, verdict: Verdict, odometry: Odometry, map_in_odom: Pose2, pose: Pose2
    ) -> Trajectory:
        """At the end of the way: what is left of it is not planned anew."""
        stamp_ns, goal, followed = odometry.stamp_ns, request.goals[-1], request.followed
        if verdict is not Verdict.LANDING:
            away, turned = errors(goal, pose)
            missed = f"came to rest {away:.3f} m and {turned:.3f} rad off the goal"
            outcome, reason = (Outcome.SUCCEEDED, "") if verdict is Verdict.REACHED else (Outcome.ABORTED, missed)
            self._end(Finished(stamp_ns, outcome, reason, None, away, turned))
        if followed is not None and stamp_ns < followed.end_ns:
            return in_frame(followed, odometry.frame_id, map_in_odom, from_ns=stamp_ns)
        return standing(request.parked_at(map_in_odom.compose(goal)), stamp_ns, odometry.frame_id)

    def _hindrance(self, odometry: Odometry, odom_in_map: Pose2 | None) -> str:
        """Why the robot must not drive now, in words; empty if it may."""
        twist = odometry.twist
        numbers = np.array([*odometry.pose.as_array(), twist.speed_mps, twist.yaw_rate_radps])
        if not np.isfinite(numbers).all():
            return "odometry is not finite"
        if np.abs(numbers).max() > _HUGE:
            return "odometry makes no sense"
        if odom_in_map is None:
            return "the robot does not know where it is"
        seen_ns = self._view.stamp_ns if self._view is not None else None
        if seen_ns is None:
            return "no scan yet"
        age_s = seconds_between(odometry.stamp_ns, seen_ns)
        if age_s > self.settings.scan_timeout_s:
            return f"no scan for {age_s:.1f} s"
        return ""

    def _wait(self, request: Request, reason: str, stamp_ns: int) -> None:
        """Stand for now; too long, and the goal is given up."""
        request.begin(stamp_ns)
        request.waits, request.followed = reason, None
        self.band.forget()
        self._give_up_if_stuck(request, stamp_ns)

    def _give_up_if_stuck(self, request: Request, stamp_ns: int) -> None:
        reason = request.given_up(stamp_ns)
        if reason:
            self._end(Finished(stamp_ns, Outcome.ABORTED, reason))

    def _note_jump(self, odom_in_map: Pose2 | None) -> None:
        before, self._odom_in_map = self._odom_in_map, odom_in_map
        if before is None or odom_in_map is None:
            return
        moved = before.inverse().compose(odom_in_map)
        if np.hypot(moved.x_m, moved.y_m) > _JUMP_M or abs(moved.yaw_rad) > _JUMP_RAD:
            if self._view is not None:
                self._view.forget()
            if self._path is not None:
                self._path.forget()
            self._start_anew()

    @property
    def _movers_now(self) -> tuple[Mover, ...]:
        return self._view.movers if self._view is not None else ()

    def _start_anew(self) -> None:
        """What was being driven is of no use any more."""
        self.band.forget()
        self._escape.stop()
        if self._request is not None:
            self._request.start_anew()

    def _end(self, finished: Finished) -> None:
        self._request, self._ended = None, finished

    def _passes(self, goal: Pose2, pose: Pose2) -> bool:
        assert self._path is not None
        near = np.hypot(goal.x_m - pose.x_m, goal.y_m - pose.y_m) <= self.settings.pass_m
        return bool(near) or self._path.first_leg_done

    def _progress(self, request: Request, pose: Pose2, stamp_ns: int) -> Progress:
        left_m = self._path.left_m if self._path is not None else 0.0
        return request.progress(pose, left_m, self.band.settings.cruise_mps, stamp_ns)
