"""Slip from three witnesses: belts, gyro and the motion of scans."""

import math
from dataclasses import dataclass, replace

import numpy as np

from tracked_localization.slip import unknown_slip
from tracked_localization.witness.felt_speed import FeltSpeed
from tracked_localization.witness.motion_record import MotionRecord
from tracked_localization.witness.scan_motion import ScanMotion, ScanMotionSettings, ScanStep
from tracked_localization.witness.settings import WitnessSettings
from tracked_localization.witness.slip_learning import SlipLearning
from tracked_localization.witness.tilt import Tilt, levelled, sensor_shift
from tracked_localization.witness.traction import Evidence, TractionJudge
from tracked_types import (
    Grip,
    ImuSample,
    LaserScan,
    Odometry,
    Pose2,
    PoseHistory,
    Slip,
    StampOrder,
    TrackSample,
    Traction,
    Twist2,
    seconds_between,
    to_nanoseconds,
)
from tracked_types.scan_points import scan_points

_LONGEST_GAP_S = 0.1
_NO_COVARIANCE3, _NO_COVARIANCE2 = np.zeros((3, 3)), np.zeros((2, 2))
_TILT_SHARE = 0.3  # of the lidar's way by tilting, that may be wrong


@dataclass(frozen=True, slots=True)
class Witnessed:
    """What is known at the stamp of one encoder sample.

    slip: in the shape that controllers take; its speed is measured. traction: shares, multiplier and whether the robot
    follows its tracks. gyro_bias_radps: as scans show it, with its variance.
    """

    slip: Slip
    traction: Traction
    gyro_bias_radps: float
    gyro_bias_variance: float


class SlipWitness:
    """Takes samples in the order in which they come; each stream's own stamps must advance.

    The yaw slip is gyro less belts and follows at once. The longitudinal slip is seen by scans alone, an interval of
    which ends half a revolution ago. Whoever is silent or refused leaves the others their say, and variances grow.
    """

    def __init__(self, settings: WitnessSettings, scanning: ScanMotionSettings | None = None) -> None:
        self._settings = settings
        self._motion = ScanMotion(scanning or ScanMotionSettings())
        self._orders = {name: StampOrder() for name in ("imu", "tracks", "scan")}
        self.refused: dict[str, int] = {}
        self._felt = FeltSpeed()
        self._traction = TractionJudge(settings)
        self._restart()

    def _restart(self) -> None:
        self._belts = MotionRecord(2)  # m along, rad of turn
        self._gyro = MotionRecord(3)  # rad of turn, pitch and roll
        self._tilt = Tilt()
        self._history = PoseHistory()
        self._felt.clear()
        self._traction.clear()
        self._motion.restart()
        self._learnt = SlipLearning(self._settings)
        self._travel: tuple[float, float] | None = None
        self._pose = Pose2(0.0, 0.0, 0.0)
        self._belt_mps = self._belt_radps = 0.0
        self._accelerates = False
        self._scan_ns: int | None = None

    def add_imu(self, sample: ImuSample) -> None:
        """Take one sample in."""
        settings = self._settings
        rates, forces = sample.angular_velocity_radps, sample.linear_acceleration_mps2
        if not (np.isfinite(rates).all() and np.isfinite(forces).all()):
            self._refuse("imu: not finite")
            return
        yaw_rate = float(np.dot(settings.imu_up, rates))
        pitch_rate, roll_rate = float(np.dot(settings.imu_left, rates)), float(np.dot(settings.imu_forward, rates))
        ahead = float(np.dot(settings.imu_forward, forces))
        duration = self._advance("imu", sample.stamp_ns)
        if duration is None:
            return
        if not 0.0 < duration <= _LONGEST_GAP_S:
            self._gyro.clear()
            self._felt.clear()
            self._tilt.clear()
            self._gyro.add(sample.stamp_ns, 0.0, 0.0, 0.0)
            return
        self._gyro.add(sample.stamp_ns, yaw_rate * duration, *self._tilt.add(duration, pitch_rate, roll_rate))
        steady = not self._accelerates and self._traction.grip is not Grip.BLOCKED
        self._felt.add_imu(duration, ahead, pitch_rate, steady=steady)

    def add_tracks(self, sample: TrackSample) -> Witnessed | None:
        """Take one sample in; what is known then, None with the first one or one that is refused."""
        if not math.isfinite(sample.left_travel_m + sample.right_travel_m):
            self._refuse("tracks: not finite")
            return None
        duration = self._advance("tracks", sample.stamp_ns)
        if duration is None:
            return None
        before, self._travel = self._travel, (sample.left_travel_m, sample.right_travel_m)
        if before is None or not 0.0 < duration <= _LONGEST_GAP_S:
            self._belts.clear()
            self._belts.add(sample.stamp_ns, 0.0, 0.0)
            return None
        left, right = self._travel[0] - before[0], self._travel[1] - before[1]
        if max(abs(left), abs(right)) > 2.0 * self._settings.belt_speed_limit_mps * duration:
            self._refuse("tracks: jump")
            self._belts.clear()
            self._belts.add(sample.stamp_ns, 0.0, 0.0)
            return None
        return self._roll(sample.stamp_ns, left, right, duration)

    def add_scan(self, scan: LaserScan) -> ScanStep | None:
        """Take one scan in; None if nothing is known of the motion since the last one."""
        if self._advance("scan", scan.stamp_ns) is None:
            return None
        settings = self._settings
        tilt = self._gyro.at(scan.stamp_ns + to_nanoseconds(0.5 * scan.time_increment_s * len(scan.ranges_m)))
        if tilt is not None:
            scan = levelled(scan, settings.lidar.yaw_rad, settings.lidar_height_m, float(tilt[1]), float(tilt[2]))
        points = scan_points(scan, settings.lidar, self._history)
        last_ns, self._scan_ns = self._scan_ns, points.stamp_ns
        here = self._history.at(np.array([points.stamp_ns], np.int64))
        since = None if last_ns is None else self._history.at(np.array([last_ns], np.int64))
        if here is None:
            self._refuse("scan: nothing heard of the motion meanwhile")
            self._motion.restart()
            return None
        if since is None:
            self._motion.restart()
            since = here
        motion = Pose2(*since[0].tolist()).inverse().compose(Pose2(*here[0].tolist()))
        duration = 0.0 if last_ns is None else seconds_between(points.stamp_ns, last_ns)
        step = self._motion.add(
            points, motion, self._learnt.motion_covariance(motion, self._belt_mps * duration, duration)
        )
        if last_ns is not None and step.step is not None:
            shifts = self._shift(last_ns), self._shift(points.stamp_ns)
            of_base = shifts[0].compose(step.step).compose(shifts[1].inverse())
            unsure = settings.step_deviation_m**2 + (_TILT_SHARE * (shifts[1].x_m - shifts[0].x_m)) ** 2
            spread = step.step_covariance + np.diag([unsure, unsure, 0.0])
            belts, gyro = (record.between(last_ns, points.stamp_ns) for record in (self._belts, self._gyro))
            turn = None if gyro is None else float(gyro[0])
            self._learnt.learn_step(points.stamp_ns, duration, of_base, spread, belts, turn)
        return replace(step, pose=step.pose.compose(self._shift(points.stamp_ns).inverse()))

    def _roll(self, stamp_ns: int, left_m: float, right_m: float, duration: float) -> Witnessed:
        settings = self._settings
        travel, asked = 0.5 * (left_m + right_m), (right_m - left_m) / settings.gauge_m
        speed, rate = travel / duration, asked / duration
        self._accelerates = abs(speed - self._belt_mps) > 0.3 * duration + settings.encoder_tick_m / duration
        self._belt_mps, self._belt_radps = speed, rate
        self._belts.add(stamp_ns, travel, asked)
        learnt = self._learnt
        learnt.pass_time(duration)
        turned = self._gyro.between(stamp_ns - to_nanoseconds(duration), stamp_ns)
        turn = None if turned is None else float(turned[0]) - learnt.bias.value * duration
        if turn is not None:
            learnt.learn_turn(turn, asked, duration)
        was_blocked = self._traction.ahead
        grip = self._judge(stamp_ns)
        if self._traction.ahead and not was_blocked:
            self._felt.doubt()
        lost = 1.0 if self._traction.ahead else learnt.share.value
        ground = (1.0 - lost) * speed
        self._felt.believe(stamp_ns, ground)
        turned_rad = turn if turn is not None else learnt.multiplier.value * asked
        self._carry_on(stamp_ns, (1.0 - lost) * travel, turned_rad, duration)
        reason = ""
        if grip is Grip.BLOCKED:
            what = f"at {speed:.2f} m/s" if self._traction.ahead else f"for {rate:.2f} rad/s"
            reason = f"{grip.value}: tracks run {what}, {self._traction.witness} sees no motion"
        slip = self._slip(stamp_ns, lost, None if turn is None else turn / duration, duration)
        share, multiplier, bias = learnt.share, learnt.multiplier, learnt.bias
        traction = Traction(
            stamp_ns,
            grip,
            self._traction.witness,
            reason,
            share.value,
            share.variance,
            multiplier.value,
            multiplier.variance,
        )
        return Witnessed(slip, traction, bias.value, bias.variance)

    def _slip(self, stamp_ns: int, lost: float, yaw_rate: float | None, duration: float) -> Slip:
        settings, learnt, speed, rate = self._settings, self._learnt, self._belt_mps, self._belt_radps
        if yaw_rate is None or abs(speed) + 0.5 * settings.gauge_m * abs(rate) < settings.encoder_tick_m / duration:
            return unknown_slip(stamp_ns)
        ahead_variance = learnt.share.variance * speed**2 + settings.encoder_tick_m**2 / (12.0 * duration**2)
        yaw_slip, yaw_variance = yaw_rate - rate, learnt.yaw_variance(duration)
        if abs(rate) > settings.least_belt_yaw_rate_radps:
            # A period's counts are rounded: the multiplier, which follows within moments, says it better.
            yaw_slip = (learnt.multiplier.value - 1.0) * rate
            yaw_variance = learnt.multiplier.variance * rate**2
        return Slip(stamp_ns, -lost * speed, yaw_slip, ahead_variance, yaw_variance, known=True, speed_measured=True)

    def _judge(self, stamp_ns: int) -> Grip:
        window_ns = to_nanoseconds(TractionJudge.TURN_WINDOW_S)
        gyro = self._gyro.between(stamp_ns - window_ns, stamp_ns)
        belts = self._belts.between(stamp_ns - window_ns, stamp_ns)
        turned = None if gyro is None else float(gyro[0]) - self._learnt.bias.value * TractionJudge.TURN_WINDOW_S
        return self._traction.update(
            Evidence(
                stamp_ns,
                self._belt_mps,
                self._belt_radps,
                self._felt.speed_mps,
                turned,
                None if belts is None else float(belts[1]),
                self._learnt.lost_by_scan(stamp_ns),
                self._learnt.turn_by_scan(stamp_ns),
            )
        )

    def _carry_on(self, stamp_ns: int, ahead_m: float, turn_rad: float, duration: float) -> None:
        """Dead reckoning that puts scans right and is the first guess of their motion."""
        half = 0.5 * turn_rad
        step = Pose2(ahead_m * math.cos(half), ahead_m * math.sin(half), turn_rad)
        self._pose = self._pose.compose(step)
        twist = Twist2(ahead_m / duration, turn_rad / duration)
        pose = self._pose.compose(self._shift(stamp_ns))
        self._history.add(Odometry(stamp_ns, "", "", pose, twist, _NO_COVARIANCE3, _NO_COVARIANCE2))

    def _shift(self, stamp_ns: int) -> Pose2:
        """How far the lidar is off its place because the robot is tilted."""
        sums = self._gyro.at(stamp_ns)
        if sums is None:
            return Pose2(0.0, 0.0, 0.0)
        return sensor_shift(self._settings.lidar_height_m, float(sums[1]), float(sums[2]))

    def _advance(self, name: str, stamp_ns: int) -> float | None:
        """Seconds since the stream's last sample; None if the sample is late or comes twice."""
        order = self._orders[name]
        if order.jumps_back(stamp_ns):
            self._refuse("clock: set back")
            for each in self._orders.values():
                each.latest_ns = None
            self._restart()
        before = order.latest_ns
        if not order.advance(stamp_ns):
            self._refuse(f"{name}: late")
            return None
        return 0.0 if before is None else seconds_between(stamp_ns, before)

    def _refuse(self, what: str) -> None:
        self.refused[what] = self.refused.get(what, 0) + 1
