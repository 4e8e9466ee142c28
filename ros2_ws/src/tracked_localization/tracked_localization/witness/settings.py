"""Settings of the slip witness."""

from dataclasses import dataclass
from typing import Any

from tracked_description import Robot
from tracked_localization.mounting import forward_axis, left_axis, up_axis
from tracked_types import Pose2
from tracked_types.setting import check_settings, setting

Axis = tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class WitnessSettings:
    """What the witness knows of the robot, and what may be tuned.

    lidar: its mounting in the base's frame; lidar_height_m: above the ground. imu_forward, imu_left, imu_up: the base's
    axes in the frame of the IMU.
    """

    gauge_m: float
    encoder_tick_m: float
    yaw_multiplier: float
    belt_speed_limit_mps: float
    gyro_noise_radps: float
    imu_period_s: float
    lidar: Pose2
    lidar_height_m: float
    imu_forward: Axis
    imu_left: Axis
    imu_up: Axis

    share_walk_sqrt_s: float = setting(
        0.15,
        "how fast the share that the ground takes of the belts' speed changes",
        unit="1/sqrt(s)",
        low=0.0,
        high=5.0,
    )
    step_deviation_m: float = setting(
        0.0015,
        "what the way between two scans may be wrong by beyond the noise of the scans",
        unit="m",
        low=0.0,
        high=0.1,
    )
    share_deviation: float = setting(
        0.3, "how far that share is from zero where nobody has seen it (one sigma)", low=0.01, high=1.0
    )
    multiplier_walk_sqrt_s: float = setting(
        0.1, "how fast the yaw rate over ground per yaw rate of the belts changes", unit="1/sqrt(s)", low=0.0, high=5.0
    )
    multiplier_deviation: float = setting(
        0.2, "how far that multiplier is from the robot's usual one where nobody has seen it", low=0.01, high=1.0
    )
    sideways_deviation_m: float = setting(
        0.1, "sideways speed per yaw rate to expect (one sigma)", unit="m", low=0.0, high=1.0
    )
    initial_bias_deviation_radps: float = setting(
        0.02, "how far from zero a gyro's bias is at start (one sigma)", unit="rad/s", low=1e-5, high=1.0
    )
    bias_walk_radps_sqrt_s: float = setting(
        0.0003, "how fast the gyro's bias changes", unit="rad/s/sqrt(s)", low=0.0, high=0.1
    )
    least_belt_speed_mps: float = setting(0.08, "slower belts bear no witness", unit="m/s", low=0.005, high=1.0)
    least_belt_yaw_rate_radps: float = setting(
        0.3, "belts that ask for less turn bear no witness of turning", unit="rad/s", low=0.01, high=3.0
    )
    blocked_share: float = setting(
        0.75, "robot that moves by less than the rest of what its belts roll is called blocked", low=0.3, high=0.99
    )
    blocked_s: float = setting(
        0.25, "it must lack motion for this long where the scan cannot tell", unit="s", low=0.05, high=2.0
    )
    scan_silence_s: float = setting(0.3, "what a scan said counts for this long", unit="s", low=0.05, high=5.0)

    def __post_init__(self) -> None:
        check_settings(self)

    @classmethod
    def from_robot(cls, robot: Robot, **tuning: Any) -> "WitnessSettings":
        """Settings for ``robot``; ``tuning`` are values of the tunable fields.

        Raises
        ------
        ValueError: if a tuned value is out of range, naming the field.
        TypeError: if a tuned field does not exist.
        """
        mounting = robot.imu.rpy_rad
        return cls(
            gauge_m=robot.tracks.gauge_m,
            encoder_tick_m=robot.tracks.encoder_tick_m,
            yaw_multiplier=robot.tracks.yaw_ratio,
            belt_speed_limit_mps=robot.tracks.speed_limit_mps,
            gyro_noise_radps=robot.imu.gyro_noise_radps,
            imu_period_s=1.0 / robot.imu.rate_hz,
            lidar=Pose2(robot.lidar.xyz_m[0], robot.lidar.xyz_m[1], robot.lidar.rpy_rad[2]),
            lidar_height_m=robot.base_link_height_m + robot.lidar.xyz_m[2],
            imu_forward=forward_axis(mounting),
            imu_left=left_axis(mounting),
            imu_up=up_axis(mounting),
            **tuning,
        )
