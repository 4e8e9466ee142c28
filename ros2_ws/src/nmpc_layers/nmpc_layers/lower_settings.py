"""Settings of the lower layer."""

from dataclasses import dataclass
from typing import Any

from nmpc_layers.drive_limits import DriveLimits
from nmpc_layers.layer_weights import METHODS, load_weights
from nmpc_layers.solver import Weights
from tracked_description import Robot
from tracked_types import PIPELINE_LATENCY_S, PLAN_RATE_HZ
from tracked_types.setting import check_settings, setting


@dataclass(frozen=True, slots=True, kw_only=True)
class LowerSettings:
    """What the lower layer knows of the robot, and what may be tuned.

    yaw_ratio: ground yaw rate per belt yaw rate, of method improved: to expect before slip is measured, and of
    changes of the command.
    """

    limits: DriveLimits
    transport_delay_s: float
    motor_lag_s: float
    yaw_ratio: float
    rate_hz: int
    weights: Weights

    method: str = setting(
        "improved",
        "thesis: the printed controller; improved: belt lag, delay compensation, targets less the slip",
        choices=METHODS,
    )
    horizon: int = setting(15, "steps of the horizon", low=2, high=120)
    constraints: str = setting(
        "box",
        "box: limits of speed and yaw rate; tracks: also of both belts and of the commands' change",
        choices=("box", "tracks"),
    )
    plan_rate_hz: int = setting(PLAN_RATE_HZ, "plans per second of the upper layer", low=1, high=30)
    pipeline_latency_s: float = setting(
        PIPELINE_LATENCY_S,
        "latency of the upper layer's plans; waiting in lock-step counts with it",
        unit="s",
        low=0.0,
        high=1.0,
    )
    plan_timeout_s: float = setting(
        0.6, "a plan stamped longer ago than this is missing", unit="s", low=0.05, high=10.0
    )
    slip_timeout_s: float = setting(
        0.1, "slip stamped longer ago than this is missing and not compensated", unit="s", low=0.0, high=10.0
    )
    slip_compensation: bool = setting(True, "compensate the measured slip")
    speed_slip: bool = setting(
        False,
        "improved: compensate the forward part of the slip even where it is the assumption (5.2.8), which odometry "
        "does not share; what is measured is always compensated",
    )
    hold_s: float = setting(0.1, "how long the last good command is held before braking", unit="s", low=0.0, high=1.0)
    weights_file: str = setting("", "YAML file of weights; empty: the packaged one")
    compile_solver: bool = setting(True, "compile the solver with the system's C compiler")

    def __post_init__(self) -> None:
        check_settings(self)
        if self.plan_timeout_s <= self.pipeline_latency_s + 1.0 / self.plan_rate_hz:
            raise ValueError(
                "LowerSettings.plan_timeout_s must exceed pipeline_latency_s plus one period of the plans, "
                f"{self.pipeline_latency_s + 1.0 / self.plan_rate_hz:g} s; got {self.plan_timeout_s}"
            )

    @classmethod
    def from_robot(cls, robot: Robot, **tuning: Any) -> "LowerSettings":
        """Settings for ``robot``; ``tuning`` are values of the tunable fields.

        Raises
        ------
        CheckedFileError: if the weights file cannot be used.
        ValueError: if a value is out of range.
        """
        weights = load_weights(tuning.get("weights_file")).of(tuning.get("method", METHODS[0])).lower
        return cls(
            limits=DriveLimits.from_robot(robot),
            transport_delay_s=robot.control.transport_delay_s,
            motor_lag_s=robot.tracks.motor_time_constant_s,
            yaw_ratio=robot.tracks.yaw_ratio,
            rate_hz=robot.control.rate_hz,
            weights=weights,
            **tuning,
        )

    @property
    def period_s(self) -> float:
        """Step of the horizon and time between commands, T_l."""
        return 1.0 / self.rate_hz
