"""What a user would reckon without the filter: wheels alone, or wheels and the bare gyro."""

import numpy as np

from tracked_lab.recordings.outdoor_drive import OutdoorDrive
from tracked_lab.recordings.recording_file import Array


def wheels_alone(drive: OutdoorDrive, gauge_m: float) -> Array:
    """Positions (m, 2) at the wheels' times."""
    return _integrated(drive, (drive.right_m - drive.left_m) / gauge_m)


def wheels_and_gyro(drive: OutdoorDrive) -> Array:
    """Positions (m, 2) at the wheels' times; the gyro as it is, bias included."""
    turned = np.concatenate([[0.0], np.cumsum(drive.gyro_radps[1:, 2] * np.diff(drive.imu_s))])
    return _integrated(drive, np.interp(drive.wheels_s, drive.imu_s, turned))


def _integrated(drive: OutdoorDrive, yaw_rad: Array) -> Array:
    travel = np.diff(0.5 * (drive.left_m + drive.right_m))
    heading = 0.5 * (yaw_rad[1:] + yaw_rad[:-1])
    steps = np.stack([travel * np.cos(heading), travel * np.sin(heading)], axis=1)
    return np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
