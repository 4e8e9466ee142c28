"""Settings of the odometry filter."""

from dataclasses import dataclass
from typing import Any

from tracked_description import Robot
from tracked_localization.mounting import up_axis
from tracked_localization.slip import SlipSettings
from tracked_types.setting import check_settings, setting


@dataclass(frozen=True, slots=True, kw_only=True)
class OdometryFilterSettings:
    """What the odometry filter knows of the robot, and what may be tuned.

    belt_yaw_ratio: yaw rate over ground per yaw rate of the belts, used only while the gyro fails.
    imu_up_axis: (3,) the base's upward axis, seen from the IMU. imu_rpy_rad: how the IMU is
    mounted, fixed-axis angles. The rates are those of ``robot.yaml``.
    """

    slip: SlipSettings
    odom_frame: str
    base_frame: str
    belt_yaw_ratio: float
    belt_speed_limit_mps: float
    belt_acceleration_mps2: float
    yaw_rate_limit_radps: float
    gyro_noise_radps: float
    gyro_bias_walk_radps_sqrt_s: float
    imu_rate_hz: int
    tracks_rate_hz: int
    imu_up_axis: tuple[float, float, float]
    imu_rpy_rad: tuple[float, float, float] = (0.0, 0.0, 0.0)

    patience_s: float = setting(
        0.012, "how long, in stamps, an estimate waits for a sample that is missing", unit="s", low=0.0, high=0.1
    )
    pose_patience_s: float = setting(
        0.5, "a measured pose may come this late, in stamps; 0: none is fused", unit="s", low=0.0, high=5.0
    )
    pose_gate_chi_square: float = setting(
        25.0, "squared innovation beyond which a measured pose is refused; three degrees of freedom", low=4.0
    )
    pose_surrender_s: float = setting(
        1.0,
        "when refused poses agree with one another for this long, the odometry moves to where they say",
        unit="s",
        low=0.0,
        high=60.0,
    )
    silence_s: float = setting(
        0.1, "a sensor that says nothing for this long is called silent", unit="s", low=0.02, high=1.0
    )
    bridged_gap_s: float = setting(
        0.2, "the pose does not advance over a longer gap in all sensors", unit="s", low=0.0, high=1.0
    )
    blame_hold_s: float = setting(
        1.0, "a sensor stays blamed for this long after its last offence", unit="s", low=0.0, high=60.0
    )
    gate_chi_square: float = setting(
        20.0, "squared innovation over its largest plausible variance beyond which a sample is refused", low=4.0
    )
    stuck_samples: int = setting(
        12, "identical samples in a row after which a gyro is called stuck; 0: never", low=0, high=1000
    )
    standstill_s: float = setting(
        0.25,
        "belts and gyro must be quiet for this long before the robot is said to stand",
        unit="s",
        low=0.05,
        high=5.0,
    )
    initial_gyro_bias_deviation_radps: float = setting(
        0.02, "how far from zero a gyro's bias is at start (one sigma)", unit="rad/s", low=1e-5, high=1.0
    )
    gyro_bias_limit_radps: float = setting(
        0.1, "a larger bias is a fault of the gyro", unit="rad/s", low=1e-4, high=1.0
    )
    longitudinal_slip: float = setting(
        0.03, "slip common to both tracks, as a share of the speed (one sigma); no sensor sees it", low=0.0, high=1.0
    )
    slip_share_walk_sqrt_s: float = setting(
        0.03,
        "how fast that share changes (one sigma after a second), where measured poses let it be learnt",
        unit="1/sqrt(s)",
        low=0.0,
        high=1.0,
    )
    slide_s: float = setting(
        0.0,
        "angle between motion and heading per yaw rate: tracks slide outwards in curves. Where measured poses show it, "
        "this is what they start from",
        unit="s",
        low=0.0,
        high=1.0,
    )
    slide_deviation_s: float = setting(
        0.1, "how far off slide_s is (one sigma), where measured poses let it be learnt", unit="s", low=0.0, high=1.0
    )
    slide_walk_sqrt_s: float = setting(
        0.01, "how fast it changes then (one sigma after a second)", unit="s/sqrt(s)", low=0.0, high=1.0
    )
    lateral_slip_m: float = setting(
        0.07, "sideways speed per yaw rate (one sigma); no sensor sees it", unit="m", low=0.0, high=1.0
    )
    lateral_slip_beside_slide_m: float = setting(
        0.03, "the same where measured poses let the slide be learnt", unit="m", low=0.0, high=1.0
    )
    settling_yaw_rad: float = setting(
        0.004, "turn that a stopping robot may still make on its belts (one sigma)", unit="rad", low=0.0, high=0.1
    )
    slip_correlation_s: float = setting(0.5, "time over which unseen slip stays alike", unit="s", low=0.01, high=60.0)
    belt_yaw_ratio_deviation: float = setting(
        0.2, "uncertainty of the robot's yaw rate over ground per yaw rate of the belts (one sigma)", low=0.01, high=1.0
    )

    def __post_init__(self) -> None:
        check_settings(self)

    @property
    def gauge_m(self) -> float:
        """Distance of the tracks' centre lines."""
        return self.slip.gauge_m

    @property
    def encoder_tick_m(self) -> float:
        """Belt travel per encoder count."""
        return self.slip.encoder_tick_m

    @property
    def rolled_variance_m2(self) -> float:
        """Variance of the rolled distance: the mean of two counters, each rounded to whole ticks."""
        return self.encoder_tick_m**2 / 24.0

    @property
    def body_yaw_acceleration_radps2(self) -> float:
        """Yaw acceleration when both belts change their speed in opposite directions as fast as they can."""
        return 2.0 * self.belt_acceleration_mps2 / self.gauge_m

    @classmethod
    def from_robot(cls, robot: Robot, slip: SlipSettings | None = None, **tuning: Any) -> "OdometryFilterSettings":
        """Settings for ``robot``; ``slip`` defaults to that of the robot, ``tuning`` are values of the tunable fields.

        Raises
        ------
        ValueError: if a tuned value is out of range, naming the field.
        TypeError: if a tuned field does not exist.
        """
        return cls(
            slip=slip or SlipSettings.from_robot(robot),
            odom_frame=robot.frames.odom,
            base_frame=robot.frames.base_footprint,
            belt_yaw_ratio=robot.tracks.yaw_ratio,
            belt_speed_limit_mps=robot.tracks.speed_limit_mps,
            belt_acceleration_mps2=robot.tracks.acceleration_limit_mps2,
            yaw_rate_limit_radps=robot.limits.yaw_rate_max_radps,
            gyro_noise_radps=robot.imu.gyro_noise_radps,
            gyro_bias_walk_radps_sqrt_s=robot.imu.gyro_bias_walk_radps_sqrt_s,
            imu_rate_hz=robot.imu.rate_hz,
            tracks_rate_hz=robot.odometry.rate_hz,
            imu_up_axis=up_axis(robot.imu.rpy_rad),
            imu_rpy_rad=robot.imu.rpy_rad,
            **tuning,
        )
