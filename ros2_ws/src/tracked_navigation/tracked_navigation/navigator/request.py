"""One request under way: its goals, what is being driven, and how far it is."""

from dataclasses import dataclass

from tracked_navigation.navigator.arrival import Arrival, errors
from tracked_navigation.navigator.progress import Progress
from tracked_navigation.navigator.settings import NavigatorSettings
from tracked_types import Pose2, Trajectory, seconds_between

_PARKING_DRIFT_M = 0.015


@dataclass(slots=True)
class Request:
    """What is asked and how it goes.

    goals: those left, poses in the map's frame. followed: what is being driven, in the map's frame. waits: why it does
    not simply go on, in words. looked_ns: when the global path was last looked at; None: it has to be now.
    """

    settings: NavigatorSettings
    goals: list[Pose2]
    arrival: Arrival
    begun_ns: int | None = None
    looked_ns: int | None = None
    replans: int = 0
    waits: str = ""
    followed: Trajectory | None = None
    _parked: Pose2 | None = None
    _headway_ns: int = 0
    _least_left_m: float = float("inf")

    def begin(self, stamp_ns: int) -> None:
        """The first instant counts."""
        if self.begun_ns is None:
            self.begun_ns = self._headway_ns = stamp_ns

    def start_anew(self) -> None:
        """What was being driven is of no use any more."""
        self.followed = self._parked = self.looked_ns = None

    def take_path(self, left_m: float, *, instead: bool) -> None:
        """There is a path of this length; ``instead`` of another one. Having less left of it is headway from now on."""
        self.replans += instead
        self._least_left_m = left_m

    def note_left(self, left_m: float, stamp_ns: int) -> None:
        """So much of the way is left."""
        if left_m < self._least_left_m - self.settings.headway_m:
            self._least_left_m, self._headway_ns = left_m, stamp_ns

    def given_up(self, stamp_ns: int) -> str:
        """Why there is no hope any more, in words; empty as long as there is."""
        stuck_s = seconds_between(stamp_ns, self._headway_ns)
        if stuck_s <= self.settings.patience_s:
            return ""
        return f"no headway for {stuck_s:.0f} s: {self.waits or 'the robot does not move'}"

    def parked_at(self, goal_in_odom: Pose2) -> Pose2:
        """Where to stand in the odometry's frame: the same place each time.

        Whoever drives the last centimetres would begin anew each time that localisation moves by a hair.
        """
        if self._parked is None or errors(self._parked, goal_in_odom)[0] > _PARKING_DRIFT_M:
            self._parked = goal_in_odom
        return self._parked

    def progress(self, pose: Pose2, left_m: float, speed_mps: float, stamp_ns: int) -> Progress:
        """For feedback."""
        since_s = 0.0 if self.begun_ns is None else seconds_between(stamp_ns, self.begun_ns)
        return Progress(pose, left_m, left_m / speed_mps, since_s, self.replans, len(self.goals), self.waits)
