"""The robot's numbers: schema of robot.yaml, checked on loading."""

from importlib import resources
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from tracked_types.checked_yaml import CheckedModel, load_checked_yaml

Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Vector = tuple[Finite, Finite, Finite]
Rate = Annotated[int, Field(gt=0, le=10_000)]
FrameName = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$")]


class Tracks(CheckedModel):
    """Track pair: geometry, encoder and drive of one belt."""

    gauge_m: Positive
    belt_width_m: Positive
    wheel_radius_m: Positive
    wheel_count: Annotated[int, Field(ge=2, le=16)]
    wheel_spacing_m: Positive
    idler_x_m: Positive
    idler_height_m: Positive
    encoder_tick_m: Positive
    speed_limit_mps: Positive
    motor_time_constant_s: Positive
    acceleration_limit_mps2: Positive
    force_limit_n: Positive
    yaw_ratio: Annotated[float, Field(ge=0.1, le=1.0)]

    @model_validator(mode="after")
    def _idlers_are_outside(self) -> "Tracks":
        outermost = 0.5 * (self.wheel_count - 1) * self.wheel_spacing_m
        if self.idler_x_m <= outermost:
            raise ValueError(
                f"idler_x_m must lie beyond the outermost road wheel at {outermost:g} m, got {self.idler_x_m:g}"
            )
        return self


class Drive(CheckedModel):
    """Speed loop of one belt: what the motor moves, its lag and the gains of its PID."""

    belt_mass_kg: Positive
    force_lag_s: Positive
    proportional_nspm: Positive
    integral_npm: NotNegative
    derivative_ns2pm: NotNegative


class Chassis(CheckedModel):
    """Rigid body carried by the suspension."""

    sprung_mass_kg: Positive
    unit_mass_kg: Positive
    inertia_kgm2: tuple[Positive, Positive, Positive]
    com_height_m: Positive
    half_extents_m: tuple[Positive, Positive, Positive]


class Suspension(CheckedModel):
    """Suspension unit of one road wheel: the X structure of (4.1.3) or a comparator."""

    kind: Literal["qzs", "linear", "locked"]
    layers: Annotated[int, Field(ge=1, le=10)]
    rod_length_m: Positive
    angle_deg: Annotated[float, Field(gt=0.0, lt=90.0)]
    spring_npm: Positive
    joint_damping_nms: NotNegative
    linear_spring_npm: Positive
    linear_damping_nspm: NotNegative
    compression_stop_m: Positive
    extension_stop_m: Positive
    stop_stiffness_npm: Positive
    stop_damping_nspm: NotNegative

    @property
    def joint_count(self) -> int:
        """Joints of one unit, n_x = 3 n + 1."""
        return 3 * self.layers + 1


class Ground(CheckedModel):
    """Contact between belt and ground where a world says nothing else."""

    friction_longitudinal: Positive
    friction_lateral: Positive
    shear_displacement_m: Positive
    rolling_resistance: NotNegative
    contact_stiffness_npm: Positive
    contact_damping_nspm: NotNegative


class Limits(CheckedModel):
    """What controllers may ask of the base, (5.2.5) and rates."""

    speed_min_mps: Finite
    speed_max_mps: Positive
    yaw_rate_max_radps: Positive
    acceleration_mps2: Positive
    braking_mps2: Positive
    yaw_acceleration_radps2: Positive

    @model_validator(mode="after")
    def _ordered(self) -> "Limits":
        if self.speed_min_mps > 0.0:
            raise ValueError(
                f"speed_min_mps must not exceed 0 (the robot must be able to stop), got {self.speed_min_mps}"
            )
        return self


class Control(CheckedModel):
    """Timing of the command path."""

    transport_delay_s: NotNegative
    command_timeout_s: Positive
    rate_hz: Rate


class OdometryRates(CheckedModel):
    """Timing of the odometry."""

    rate_hz: Rate


class Mount(CheckedModel):
    """Pose of a sensor in base_link."""

    xyz_m: Vector
    rpy_rad: Vector


class Imu(Mount):
    """Inertial sensor: pose, rate and error model."""

    rate_hz: Rate
    gyro_noise_radps: NotNegative
    gyro_bias_radps: Finite
    gyro_bias_walk_radps_sqrt_s: NotNegative
    acceleration_noise_mps2: NotNegative
    acceleration_bias_mps2: Finite


class Lidar(Mount):
    """Planar lidar: pose, rate and error model."""

    rate_hz: Rate
    beams: Annotated[int, Field(ge=8, le=100_000)]
    range_min_m: NotNegative
    range_max_m: Positive
    noise_m: NotNegative


class Frames(CheckedModel):
    """Frame names without prefix."""

    odom: FrameName
    base_footprint: FrameName
    base_link: FrameName
    imu: FrameName
    lidar: FrameName
    camera: FrameName
    camera_optical: FrameName


class Robot(CheckedModel):
    """Everything the stack knows about one robot."""

    name: FrameName
    tracks: Tracks
    drive: Drive
    chassis: Chassis
    suspension: Suspension
    ground: Ground
    limits: Limits
    control: Control
    odometry: OdometryRates
    imu: Imu
    lidar: Lidar
    camera: Mount
    base_link_height_m: Positive
    frames: Frames


def load_robot(path: Path | str | None = None) -> Robot:
    """Read and check a robot file; without a path (or with an empty one), the packaged robot.yaml.

    Raises
    ------
    CheckedFileError: if the file is missing, is not YAML, or a key is missing, unknown or out of range.
    """
    if path:
        return load_checked_yaml(Robot, Path(path))
    return load_checked_yaml(Robot, resources.files("tracked_description") / "data" / "robot.yaml", "robot.yaml")
