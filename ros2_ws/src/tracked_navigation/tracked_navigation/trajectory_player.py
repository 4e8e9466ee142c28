"""Plays a trajectory: pieces of reference ahead of the robot, and word of its arrival."""

import enum
import math
from dataclasses import dataclass

import numpy as np

from tracked_navigation.legs import placed, sample_times
from tracked_navigation.reference import NamedTrajectory
from tracked_types import (
    NANOSECONDS_PER_SECOND,
    PLAN_RATE_HZ,
    GoalReached,
    Odometry,
    PeriodGrid,
    Pose2,
    StampOrder,
    Trajectory,
    angle_difference,
    seconds_between,
    to_nanoseconds,
)
from tracked_types.setting import check_settings, setting

_CLOSURE_M = 0.01
_CLOSURE_RAD = 0.01


class Phase(enum.Enum):
    """Where the player is."""

    WAITING = "waiting for odometry"
    STARTING = "holding the start pose"
    PLAYING = "playing"
    ARRIVING = "waiting for the robot to come to rest at the goal"
    REACHED = "goal reached"
    NOT_REACHED = "goal not reached in time"


@dataclass(frozen=True, slots=True, kw_only=True)
class PlayerSettings:
    """How a trajectory is handed out and when its end counts as reached."""

    anchor: str = setting(
        "start",
        "start: the trajectory starts at the pose of the first odometry; odom: it is given in the odometry frame",
        choices=("start", "odom"),
    )
    start_delay_s: float = setting(
        1.0, "least time at rest before the trajectory starts, at a whole second", unit="s", low=0.0, high=60.0
    )
    rate_hz: int = setting(
        PLAN_RATE_HZ, "pieces of reference per second: one for each plan of the upper layer", low=1, high=30
    )
    horizon_s: float = setting(3.0, "length of one piece of reference", unit="s", low=0.2, high=60.0)
    spacing_s: float = setting(0.05, "time between two points of a piece", unit="s", low=0.01, high=1.0)
    loop: bool = setting(False, "start over at the end; the trajectory must end where it starts")
    goal_position_tolerance_m: float = setting(0.05, "position error of a reached goal", unit="m", low=0.0, high=5.0)
    goal_yaw_tolerance_rad: float = setting(0.1, "heading error of a reached goal", unit="rad", low=0.0, high=3.2)
    rest_speed_mps: float = setting(0.02, "forward speed that counts as rest", unit="m/s", low=0.0, high=1.0)
    rest_yaw_rate_radps: float = setting(0.05, "yaw rate that counts as rest", unit="rad/s", low=0.0, high=1.0)
    rest_time_s: float = setting(0.2, "how long the robot must rest at the goal", unit="s", low=0.0, high=10.0)
    goal_patience_s: float = setting(
        8.0, "time after the end until the goal counts as not reached", unit="s", low=0.1, high=600.0
    )

    def __post_init__(self) -> None:
        check_settings(self)
        if self.spacing_s > self.horizon_s:
            raise ValueError(
                f"PlayerSettings.spacing_s must not exceed horizon_s, got {self.spacing_s} > {self.horizon_s}"
            )


@dataclass(frozen=True, slots=True)
class PlayerOutput:
    """What one odometry brought about: a piece of reference at the instants of its grid, the arrival once."""

    reference: Trajectory | None = None
    reached: GoalReached | None = None


class TrajectoryPlayer:
    """Hands out a trajectory in pieces, on the stamps of the odometry.

    A piece starts at an instant of the grid and is stamped with it, the first one at the instant before the first
    odometry; its points lie on one grid with those of the
    pieces before and after, so whoever interpolates gets the same reference from any of them. Before the
    start the start pose is held, after the end the final pose, both with zero inputs. The start is a whole
    second of physical time, so that it does not depend on how many messages were lost before everybody
    knew everybody.

    Raises
    ------
    ValueError: if ``loop`` is set and the trajectory does not end where it starts.
    """

    def __init__(self, settings: PlayerSettings, reference: NamedTrajectory) -> None:
        self.settings = settings
        self.name = reference.name
        self.ignored_odometry = 0
        self._shape = reference.trajectory
        if settings.loop:
            _check_closed(reference)
        self._grid = PeriodGrid(settings.rate_hz)
        count = math.floor(settings.horizon_s / settings.spacing_s + 1e-9) + 1
        self._offsets_s = sample_times(count, settings.spacing_s)
        self.restart()

    def restart(self) -> None:
        """Forget the robot; the next odometry anchors the trajectory anew."""
        self.phase = Phase.WAITING
        self._track: Trajectory | None = None
        self._order = StampOrder()
        self._rest_since_ns: int | None = None

    def update(self, odometry: Odometry) -> PlayerOutput:
        """React to one odometry (planar pose in its ``frame_id``).

        Odometry that is out of order or not finite is ignored and counted; one that jumps back by more
        than half a second means a reset world, and the trajectory starts over.
        """
        pose = odometry.pose
        if not (math.isfinite(pose.x_m) and math.isfinite(pose.y_m) and math.isfinite(pose.yaw_rad)):
            self.ignored_odometry += 1
            return PlayerOutput()
        if self._order.jumps_back(odometry.stamp_ns):
            self.restart()
        if not self._order.advance(odometry.stamp_ns):
            self.ignored_odometry += 1
            return PlayerOutput()
        previous_ns = self._order.previous_ns
        if self._track is None:
            self._track = self._anchored(odometry)
            # The first piece at once: whoever plans at the next instant must have it by then.
            previous_ns = self._grid.stamp_ns(self._grid.index_at(odometry.stamp_ns)) - 1
        instants = self._grid.crossed(previous_ns, odometry.stamp_ns)
        reached = self._judge(odometry, self._track)
        if not instants:
            return PlayerOutput(reached=reached)
        return PlayerOutput(self._piece(self._track, self._grid.stamp_ns(instants[-1])), reached)

    @property
    def goal(self) -> Pose2 | None:
        """Final pose in the odometry frame, once anchored."""
        return None if self._track is None else Pose2(*(float(value) for value in self._track.states[-1]))

    @property
    def progress(self) -> float:
        """Share of the trajectory's time that has passed, 0 to 1 (of the lap, when looping)."""
        if self._track is None or self._order.latest_ns is None:
            return 0.0
        elapsed = seconds_between(self._order.latest_ns, self._track.stamp_ns)
        share = elapsed / float(self._track.times_s[-1])
        return max(share % 1.0 if self.settings.loop else min(share, 1.0), 0.0)

    def _anchored(self, odometry: Odometry) -> Trajectory:
        origin = odometry.pose if self.settings.anchor == "start" else Pose2(0.0, 0.0, 0.0)
        earliest = odometry.stamp_ns + to_nanoseconds(self.settings.start_delay_s)
        start_ns = -(-earliest // NANOSECONDS_PER_SECOND) * NANOSECONDS_PER_SECOND
        return placed(self._shape, origin, start_ns, odometry.frame_id)

    def _piece(self, track: Trajectory, stamp_ns: int) -> Trajectory:
        elapsed = seconds_between(stamp_ns, track.stamp_ns) + self._offsets_s
        duration = float(track.times_s[-1])
        if self.settings.loop:
            elapsed = np.where(elapsed > 0.0, np.mod(elapsed, duration), elapsed)
        states, inputs = track.at(track.stamp_ns, elapsed)
        inputs[(elapsed < 0.0) | (elapsed >= duration)] = 0.0
        return Trajectory(stamp_ns, track.frame_id, self._offsets_s, states, inputs)

    def _judge(self, odometry: Odometry, track: Trajectory) -> GoalReached | None:
        """Advance the phase; the arrival, when it is now."""
        if odometry.stamp_ns < track.end_ns or self.settings.loop:
            self.phase = Phase.STARTING if odometry.stamp_ns < track.start_ns else Phase.PLAYING
            return None
        if self.phase is Phase.REACHED:
            return None
        position_error, yaw_error = self._errors(odometry, track)
        if not self._rests_at_goal(odometry, position_error, yaw_error):
            self._rest_since_ns = None
            late = seconds_between(odometry.stamp_ns, track.end_ns) > self.settings.goal_patience_s
            self.phase = Phase.NOT_REACHED if late else Phase.ARRIVING
            return None
        if self._rest_since_ns is None:
            self._rest_since_ns = odometry.stamp_ns
        if seconds_between(odometry.stamp_ns, self._rest_since_ns) < self.settings.rest_time_s:
            return None
        self.phase = Phase.REACHED
        return GoalReached(odometry.stamp_ns, self.name, position_error, yaw_error)

    def _errors(self, odometry: Odometry, track: Trajectory) -> tuple[float, float]:
        x, y, yaw = (float(value) for value in track.states[-1])
        pose = odometry.pose
        return math.hypot(x - pose.x_m, y - pose.y_m), abs(angle_difference(yaw, pose.yaw_rad))

    def _rests_at_goal(self, odometry: Odometry, position_error: float, yaw_error: float) -> bool:
        settings, twist = self.settings, odometry.twist
        return (
            position_error <= settings.goal_position_tolerance_m
            and yaw_error <= settings.goal_yaw_tolerance_rad
            and abs(twist.speed_mps) <= settings.rest_speed_mps
            and abs(twist.yaw_rate_radps) <= settings.rest_yaw_rate_radps
        )


def _check_closed(reference: NamedTrajectory) -> None:
    first, last = reference.trajectory.states[0], reference.trajectory.states[-1]
    gap = float(np.hypot(*(last[:2] - first[:2])))
    turned = abs(float(angle_difference(float(last[2]), float(first[2]))))
    if gap > _CLOSURE_M or turned > _CLOSURE_RAD:
        raise ValueError(
            f"loop: {reference.name} ends {gap:.3g} m and {turned:.3g} rad from where it starts; only a closed "
            "trajectory can start over"
        )
