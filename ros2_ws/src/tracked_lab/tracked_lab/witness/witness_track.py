"""What the slip witness says along a drive, beside the truth."""

from collections.abc import Callable
from dataclasses import dataclass, field
from time import thread_time

import numpy as np
from numpy.typing import NDArray

from tracked_description import Robot
from tracked_localization.witness.settings import WitnessSettings
from tracked_localization.witness.slip_witness import SlipWitness
from tracked_types import BodyState, Grip, ImuSample, LaserScan, Slip, TrackSample

Array = NDArray[np.float64]


@dataclass
class WitnessTrack:
    """One row per encoder period (n,) each: stamps (s), belts, what the ground adds (truth and estimate), truth of the
    motion, and whether the robot was called blocked. scan_s: processor time of each scan."""

    robot: Robot
    witness: SlipWitness = field(init=False)
    rows: list[tuple[float, ...]] = field(default_factory=list)
    scan_s: list[float] = field(default_factory=list)
    _travel: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        self.witness = SlipWitness(WitnessSettings.from_robot(self.robot))

    def add(
        self,
        imu: tuple[ImuSample, ...],
        tracks: tuple[TrackSample, ...],
        scans: tuple[LaserScan, ...],
        truth: tuple[BodyState, ...],
        slips: tuple[Slip, ...],
    ) -> None:
        """Take one tick of a plant in."""
        for inertial in imu:
            self.witness.add_imu(inertial)
        said = None
        for counted in tracks:
            said = self.witness.add_tracks(counted)
        for scan in scans:
            begin = thread_time()
            self.witness.add_scan(scan)
            self.scan_s.append(thread_time() - begin)
        if not tracks:
            return
        travel = (tracks[-1].left_travel_m, tracks[-1].right_travel_m)
        before, self._travel = self._travel, travel
        if said is None or before is None or not truth or not slips:
            return
        rate_hz = self.robot.odometry.rate_hz
        left, right = (travel[0] - before[0]) * rate_hz, (travel[1] - before[1]) * rate_hz
        self.rows.append(
            (
                said.slip.stamp_ns * 1e-9,
                0.5 * (left + right),
                (right - left) / self.robot.tracks.gauge_m,
                said.slip.speed_mps,
                slips[0].speed_mps,
                said.slip.yaw_rate_radps,
                slips[0].yaw_rate_radps,
                float(said.traction.grip is Grip.BLOCKED),
                said.traction.lost_share_variance,
            )
        )

    def columns(self) -> "Columns":
        """The rows as arrays."""
        return Columns(*np.array(self.rows).T)


@dataclass(frozen=True)
class Columns:
    """Arrays (n,) over the encoder periods of a drive."""

    time_s: Array
    belt_mps: Array
    belt_radps: Array
    speed_slip: Array
    true_speed_slip: Array
    yaw_slip: Array
    true_yaw_slip: Array
    blocked: Array
    share_variance: Array

    def share_errors(self, least_mps: float = 0.3) -> tuple[Array, Array]:
        """Times and errors of the longitudinal slip as a share of the belts' speed, where that is high enough."""
        fast = np.abs(self.belt_mps) > least_mps
        return self.time_s[fast], ((self.speed_slip - self.true_speed_slip)[fast] / self.belt_mps[fast])

    def yaw_errors(self, least_radps: float = 0.5) -> tuple[Array, Array]:
        """The same of the yaw slip."""
        fast = np.abs(self.belt_radps) > least_radps
        return self.time_s[fast], ((self.yaw_slip - self.true_yaw_slip)[fast] / self.belt_radps[fast])

    def still(self, follows: float = 0.25) -> NDArray[np.bool_]:
        """Where the robot follows, over a tenth of a second, by less than this share of what the belts ask."""
        rolls, spins = _smooth(self.belt_mps), _smooth(self.belt_radps)
        moves, turns = _smooth(self.belt_mps + self.true_speed_slip), _smooth(self.belt_radps + self.true_yaw_slip)
        ahead, turning = np.abs(rolls) > 0.1, np.abs(spins) > 0.4
        stands = ahead & (moves * np.sign(rolls) < follows * np.abs(rolls))
        unturned = turning & (turns * np.sign(spins) < follows * np.abs(spins))
        unmoved: NDArray[np.bool_] = stands | unturned
        return unmoved

    def detected_after_s(self) -> float:
        """Time from the beginning of the first standstill of half a second to the alarm; inf if none came."""
        still = self.still()
        run = 0
        for index, value in enumerate(still):
            run = run + 1 if value else 0
            if run * (self.time_s[1] - self.time_s[0]) >= 0.5:
                begin = self.time_s[index - run + 1]
                alarms = self.time_s[(self.blocked > 0.0) & (self.time_s >= begin)]
                return float(alarms[0] - begin) if len(alarms) else float("inf")
        raise ValueError("the robot was never held")

    def false_alarms(self) -> int:
        """Alarms that began while the robot had followed its tracks for the last half second."""
        begins = np.flatnonzero(np.diff(np.concatenate([[0.0], self.blocked])) > 0.0)
        still = self.still(follows=0.5)
        window = round(0.5 / (self.time_s[1] - self.time_s[0]))
        return sum(not still[max(0, begin - window) : begin + 1].any() for begin in begins)


def _smooth(values: Array) -> Array:
    """Mean over the last tenth of a second."""
    kernel = np.ones(6) / 6.0
    smoothed: Array = np.convolve(values, kernel)[: len(values)]
    return smoothed


Steer = Callable[[float, BodyState | None], tuple[float, float]]
"""Time (s) and the truth to speed (m/s) and yaw rate (rad/s)."""
