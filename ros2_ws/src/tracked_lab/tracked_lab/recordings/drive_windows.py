"""Two-second windows of a real skid-steer vehicle that slips: wheel speeds, and pose from lidar ICP."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tracked_lab.recordings.recording_file import Array, RecordingError, load_arrays

PERIOD_S = 0.05
_LONGEST_STEP_M, _LARGEST_TURN_RAD = 0.3, 0.5
_FIELDS = ("left_wheel_vel", "right_wheel_vel", "icp_x", "icp_y", "icp_yaw")


@dataclass(frozen=True, slots=True)
class DriveWindows:
    """n windows of m samples, `PERIOD_S` apart: all arrays (n, m).

    left_mps, right_mps: speeds of the wheels' rims. x_m, y_m, yaw_rad: pose from ICP, yaw without jumps.
    left_out: windows of the recording that are not among them.
    """

    left_mps: Array
    right_mps: Array
    x_m: Array
    y_m: Array
    yaw_rad: Array
    left_out: int = 0

    def __len__(self) -> int:
        return len(self.x_m)

    @property
    def yaw_steps_rad(self) -> Array:
        """Turn (n, m - 1) from each sample to the next."""
        return np.diff(self.yaw_rad, axis=1)

    @property
    def end_m(self) -> Array:
        """Position (n, 2) at the end."""
        return np.stack([self.x_m[:, -1], self.y_m[:, -1]], axis=1)


def load_drive_windows(wheel_radius_m: float, path: Path | None = None) -> DriveWindows:
    """The windows in which every value is there and no pose jumps.

    The recording's IMU heading contradicts ICP and is not used; rate and wheel radius are not in the recording, and
    were inferred from distance over speed.

    Raises
    ------
    RecordingError: if the file cannot be used.
    """
    fields = load_arrays("norlab_drive_husky", _FIELDS, path)
    left, right, x, y, yaw = (fields[name] for name in _FIELDS)
    if not x.ndim == 2 or any(array.shape != x.shape for array in fields.values()):
        raise RecordingError("norlab_drive_husky.npz: the fields differ in shape")
    yaw = np.unwrap(yaw, axis=1)
    clean = np.all([np.isfinite(array).all(axis=1) for array in (left, right, x, y, yaw)], axis=0)
    with np.errstate(invalid="ignore"):
        clean &= np.hypot(np.diff(x, axis=1), np.diff(y, axis=1)).max(axis=1) < _LONGEST_STEP_M
        clean &= np.abs(np.diff(yaw, axis=1)).max(axis=1) < _LARGEST_TURN_RAD
    if not clean.any():
        raise RecordingError("norlab_drive_husky.npz: no window is clean")
    return DriveWindows(
        wheel_radius_m * left[clean], wheel_radius_m * right[clean], x[clean], y[clean], yaw[clean], int((~clean).sum())
    )
