"""Settings of the upper layer."""

from dataclasses import dataclass, replace
from typing import Any

from nmpc_layers.certified_terminal import CertifiedTerminal, load_certified_terminal
from nmpc_layers.drive_limits import DriveLimits
from nmpc_layers.goal_approach import ApproachSettings
from nmpc_layers.layer_weights import METHODS, MethodWeights, load_weights, weights_folder
from nmpc_layers.manoeuvre import ManoeuvreRates
from nmpc_layers.solver import Weights
from tracked_description import Robot
from tracked_types import PIPELINE_LATENCY_S, PLAN_RATE_HZ
from tracked_types.setting import check_settings, setting


@dataclass(frozen=True, slots=True, kw_only=True)
class UpperSettings:
    """What the upper layer knows of the robot, and what may be tuned."""

    limits: DriveLimits
    transport_delay_s: float
    motor_lag_s: float
    control_rate_hz: int
    weights: Weights
    certified: CertifiedTerminal | None = None

    method: str = setting(
        "improved",
        "thesis: the printed controller; improved: midpoint headings, states predicted to actuation",
        choices=METHODS,
    )
    layers: str = setting(
        "double",
        "double: publish trajectories for the lower layer; single: command the base from this layer alone",
        choices=("double", "single"),
    )
    rate_hz: int = setting(
        PLAN_RATE_HZ, "plans per second; also the inverse of the step of the horizon", low=1, high=30
    )
    horizon: int = setting(10, "steps of the horizon", low=2, high=120)
    pipeline_latency_s: float = setting(
        PIPELINE_LATENCY_S,
        "a plan made from the odometry of one instant takes effect this much later: the processing time of mapping "
        "and planning that the layer waits for",
        unit="s",
        low=0.0,
        high=1.0,
    )
    predict_latency: bool = setting(
        False, "layers single: plan from the state predicted to where the plan takes effect, not from the measured one"
    )
    reference_timeout_s: float = setting(
        0.5, "a reference older than this and still moving is missing", unit="s", low=0.05, high=10.0
    )
    hold_s: float = setting(0.1, "how long the last good command is held before braking", unit="s", low=0.0, high=1.0)
    final_approach: bool = setting(True, "drive the last centimetres to where the reference comes to rest")
    approach_position_tolerance_m: float = setting(
        0.01, "position error at which the final approach ends", unit="m", low=0.001, high=0.5
    )
    approach_yaw_tolerance_rad: float = setting(
        0.02, "heading error at which the final approach ends", unit="rad", low=0.001, high=1.0
    )
    approach_attempts: int = setting(5, "manoeuvres of one final approach", low=1, high=100)
    approach_speed_mps: float = setting(0.15, "largest speed of the final approach", unit="m/s", low=0.01, high=1.0)
    approach_yaw_rate_radps: float = setting(
        0.5, "largest yaw rate of the final approach", unit="rad/s", low=0.01, high=3.0
    )
    slide_compensation: bool = setting(
        True,
        "layers double, improved: plan with the sideways slide that the slip estimate reports; measured poses show it",
    )
    terminal: str = setting(
        "certified",
        "layers double: weight of the last pose error. certified: the proven one that the weights name, if they name "
        "one, where the reference is within its range; scaled: the others' times a factor",
        choices=("certified", "scaled"),
    )
    weights_file: str = setting("", "YAML file of weights; empty: the packaged one")
    compile_solver: bool = setting(True, "compile the solver with the system's C compiler")

    def __post_init__(self) -> None:
        check_settings(self)
        if self.control_rate_hz % self.rate_hz:
            raise ValueError(
                f"UpperSettings.rate_hz must divide the control rate of {self.control_rate_hz} Hz, got {self.rate_hz}"
            )

    @classmethod
    def from_robot(cls, robot: Robot, **tuning: Any) -> "UpperSettings":
        """Settings for ``robot``; ``tuning`` are values of the tunable fields.

        Raises
        ------
        CheckedFileError: if the weights file cannot be used, or a certified weight is damaged or for other settings.
        ValueError: if a value is out of range.
        """
        of_method = load_weights(tuning.get("weights_file")).of(tuning.get("method", METHODS[0]))
        single = tuning.get("layers") == "single"
        settings = cls(
            limits=DriveLimits.from_robot(robot),
            transport_delay_s=robot.control.transport_delay_s,
            motor_lag_s=robot.tracks.motor_time_constant_s,
            control_rate_hz=robot.control.rate_hz,
            weights=of_method.single if single else of_method.upper,
            **tuning,
        )
        return settings if single or settings.terminal == "scaled" else settings._with_proof(of_method)

    def _with_proof(self, weights: MethodWeights) -> "UpperSettings":
        """These settings with the certified terminal weight that the weights name, if they do."""
        if weights.upper_terminal is None:
            return self
        certified = load_certified_terminal(
            weights_folder(self.weights_file),
            weights.upper_terminal,
            self.weights,
            self.limits,
            period_s=self.period_s,
            heading_point=heading_point_of(self.method),
        )
        return replace(self, certified=certified)

    @property
    def knows_slide(self) -> bool:
        """Whether the model has the sideways slide; that of a layer alone, or as printed, has no slip of any kind."""
        return self.slide_compensation and self.layers == "double" and self.method == "improved"

    @property
    def period_s(self) -> float:
        """Step of the horizon and time between plans, T_u."""
        return 1.0 / self.rate_hz

    @property
    def horizon_start_s(self) -> float:
        """From the stamp of an odometry to the start of the horizon planned from it."""
        if self.layers == "single":
            return self.pipeline_latency_s + self.transport_delay_s if self.predict_latency else 0.0
        return self.transport_delay_s if self.method == "improved" else 0.0

    @property
    def approach(self) -> ApproachSettings:
        """Settings of the final approach; accelerations are a third of the robot's."""
        rates = ManoeuvreRates(
            self.approach_speed_mps,
            self.approach_yaw_rate_radps,
            min(self.limits.acceleration_mps2, self.limits.braking_mps2) / 3.0,
            self.limits.yaw_acceleration_radps2 / 3.0,
        )
        return ApproachSettings(
            position_tolerance_m=self.approach_position_tolerance_m,
            yaw_tolerance_rad=self.approach_yaw_tolerance_rad,
            attempts=self.approach_attempts,
            rates=rates,
        )


def heading_point_of(method: str) -> float:
    """Where in a step the upper layer's model takes its heading, see `MotionParameters`."""
    return 0.5 if method == "improved" else 0.0
