"""Pure pursuit, and pure pursuit with a regulated speed as Nav2's controller of that name has it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from tracked_description import Robot
from tracked_lab.peers.control_peer import SHARED, ControlPeer, in_robot_frame
from tracked_lab.tuning import check_known, tuning_of
from tracked_types import Odometry, Trajectory, Twist2, angle_difference
from tracked_types.setting import check_settings, setting

_NEAR_M = 0.03


@dataclass(frozen=True, slots=True, kw_only=True)
class PursuitSettings:
    """Where the carrot hangs, and how fast it is chased."""

    lookahead_s: float = setting(0.8, "the carrot is where the reference will be then", unit="s", low=0.1, high=3.0)
    speed_gain: float = setting(1.0, "part of the distance to the carrot that counts for the speed", low=0.0, high=3.0)
    turn_gain: float = setting(
        2.0, "yaw rate per heading error where the reference rests", unit="1/s", low=0.0, high=10.0
    )

    def __post_init__(self) -> None:
        check_settings(self)


class PurePursuit:
    """An arc to the carrot, driven so that it would be reached when the reference is there."""

    def __init__(self, settings: PursuitSettings) -> None:
        self._settings = settings

    def steer(self, odometry: Odometry, reference: Trajectory) -> Twist2:
        """The arc; where the carrot is underfoot, a turn to its heading."""
        settings = self._settings
        states, inputs = reference.at(odometry.stamp_ns, np.array([0.0, settings.lookahead_s]))
        ahead, left = in_robot_frame(odometry, states[1:])[0].tolist()
        distance = math.hypot(ahead, left)
        if distance < _NEAR_M:
            return Twist2(0.0, settings.turn_gain * angle_difference(float(states[1, 2]), odometry.pose.yaw_rad))
        chased = math.copysign(distance, ahead) / settings.lookahead_s
        speed = (1.0 - settings.speed_gain) * float(inputs[0, 0]) + settings.speed_gain * chased
        return Twist2(speed, speed * 2.0 * left / distance**2)


@dataclass(frozen=True, slots=True, kw_only=True)
class RegulatedSettings:
    """The parameters of Nav2's controller that matter where there are no obstacles."""

    lookahead_time_s: float = setting(1.5, "lookahead distance per speed", unit="s", low=0.1, high=5.0)
    min_lookahead_m: float = setting(0.3, "least lookahead distance", unit="m", low=0.05, high=2.0)
    max_lookahead_m: float = setting(0.9, "largest lookahead distance", unit="m", low=0.1, high=5.0)
    min_radius_m: float = setting(0.9, "tighter arcs are driven more slowly in proportion", unit="m", low=0.0, high=5.0)
    min_speed_mps: float = setting(0.1, "least regulated speed", unit="m/s", low=0.0, high=0.5)
    approach_m: float = setting(0.6, "slow down within this distance of the end", unit="m", low=0.0, high=3.0)
    catch_up_per_s: float = setting(
        1.0,
        "speed added per metre that the robot is behind its time; 0 as in Nav2, which knows no time",
        low=0.0,
        high=5.0,
    )
    turn_gain: float = setting(2.0, "yaw rate per heading error at the end", unit="1/s", low=0.0, high=10.0)

    def __post_init__(self) -> None:
        check_settings(self)


class RegulatedPurePursuit:
    """An arc to a point ahead on the path, at the reference's speed, less in tight arcs and at the end."""

    def __init__(self, settings: RegulatedSettings) -> None:
        self._settings = settings

    def steer(self, odometry: Odometry, reference: Trajectory) -> Twist2:
        """The arc; at the end, a turn to its heading."""
        settings = self._settings
        seen = in_robot_frame(odometry, reference.states)
        distances = np.hypot(seen[:, 0], seen[:, 1])
        now, inputs = reference.at(odometry.stamp_ns, np.zeros(1))
        nearest = int(np.argmin(distances))
        lookahead = settings.lookahead_time_s * abs(odometry.twist.speed_mps)
        lookahead = min(max(lookahead, settings.min_lookahead_m), settings.max_lookahead_m)
        beyond = np.flatnonzero(distances[nearest:] >= lookahead)
        carrot = seen[nearest + beyond[0]] if len(beyond) else seen[-1]
        ahead, left = carrot.tolist()
        reach = math.hypot(ahead, left)
        ends = float(np.abs(reference.inputs[-1]).max()) == 0.0
        if ends and float(distances[-1]) < _NEAR_M:
            turn = angle_difference(float(reference.states[-1, 2]), odometry.pose.yaw_rad)
            return Twist2(0.0, settings.turn_gain * turn)
        curvature = 2.0 * left / max(reach, 1e-3) ** 2
        behind = float(in_robot_frame(odometry, now)[0, 0])
        wanted = float(inputs[0, 0]) + settings.catch_up_per_s * behind
        speed = wanted * self._regulation(abs(curvature))
        if ends and float(distances[-1]) < settings.approach_m:
            speed = min(speed, max(settings.min_speed_mps, 0.5 * float(distances[-1]) / max(settings.approach_m, 1e-3)))
        return Twist2(speed, speed * curvature)

    def _regulation(self, curvature: float) -> float:
        settings = self._settings
        if curvature * settings.min_radius_m <= 1.0:
            return 1.0
        return max(1.0 / (curvature * settings.min_radius_m), min(1.0, settings.min_speed_mps / 0.5))


def pure_pursuit(robot: Robot, parameters: Mapping[str, Any]) -> ControlPeer:
    """Pure pursuit of a carrot that hangs in time."""
    check_known("pure_pursuit", parameters, (PursuitSettings,), *SHARED)
    law = PurePursuit(PursuitSettings(**tuning_of(PursuitSettings, parameters)))
    return ControlPeer(law, robot, parameters["pipeline_latency_s"])


def regulated_pure_pursuit(robot: Robot, parameters: Mapping[str, Any]) -> ControlPeer:
    """Pure pursuit with a regulated speed."""
    check_known("regulated_pure_pursuit", parameters, (RegulatedSettings,), *SHARED)
    law = RegulatedPurePursuit(RegulatedSettings(**tuning_of(RegulatedSettings, parameters)))
    return ControlPeer(law, robot, parameters["pipeline_latency_s"])
