"""What each way to reckon makes of a window: forward travel, sideways travel and turn of every step."""

from dataclasses import dataclass

import numpy as np

from tracked_lab.recordings.drive_windows import PERIOD_S, DriveWindows
from tracked_lab.recordings.recording_file import Array
from tracked_localization import SlipEstimator, SlipSettings
from tracked_types import to_nanoseconds


@dataclass(frozen=True, slots=True)
class Motion:
    """Motion of the body by step: forward_m, sideways_m, turn_rad, all (n, m - 1)."""

    forward_m: Array
    sideways_m: Array
    turn_rad: Array

    def end_m(self, windows: DriveWindows) -> Array:
        """Position (n, 2) after the last step, from the first pose of each window; each step along its mean heading."""
        heading = windows.yaw_rad[:, :1] + np.cumsum(self.turn_rad, axis=1) - 0.5 * self.turn_rad
        cosine, sine = np.cos(heading), np.sin(heading)
        x_m = windows.x_m[:, 0] + (self.forward_m * cosine - self.sideways_m * sine).sum(axis=1)
        y_m = windows.y_m[:, 0] + (self.forward_m * sine + self.sideways_m * cosine).sum(axis=1)
        return np.stack([x_m, y_m], axis=1)


def true_motion(windows: DriveWindows) -> Motion:
    """The motion that ICP saw."""
    turn = windows.yaw_steps_rad
    heading = windows.yaw_rad[:, :-1] + 0.5 * turn
    dx, dy = np.diff(windows.x_m, axis=1), np.diff(windows.y_m, axis=1)
    cosine, sine = np.cos(heading), np.sin(heading)
    return Motion(dx * cosine + dy * sine, dy * cosine - dx * sine, turn)


def wheel_motion(windows: DriveWindows, gauge_m: float) -> Motion:
    """The motion that the wheels would make if they did not slip."""
    left, right = wheel_steps_m(windows)
    forward = 0.5 * (left + right)
    return Motion(forward, np.zeros_like(forward), (right - left) / gauge_m)


def slip_motion(windows: DriveWindows, settings: SlipSettings) -> Array:
    """What the slip object adds to the forward travel (n, m - 1); the yaw rate of ICP stands in for the gyro's."""
    left, right = wheel_steps_m(windows)
    turn = windows.yaw_steps_rad
    added = np.zeros_like(turn)
    for window in range(len(windows)):
        estimator = SlipEstimator(settings)
        for step in range(turn.shape[1]):
            slip = estimator.update(
                to_nanoseconds((step + 1) * PERIOD_S),
                float(left[window, step]) / PERIOD_S,
                float(right[window, step]) / PERIOD_S,
                float(turn[window, step]) / PERIOD_S,
                0.0,
                PERIOD_S,
            )
            added[window, step] = slip.speed_mps * PERIOD_S
    return added


def wheel_steps_m(windows: DriveWindows) -> tuple[Array, Array]:
    """Travel of the left and right wheels by step (n, m - 1)."""
    return _means(windows.left_mps) * PERIOD_S, _means(windows.right_mps) * PERIOD_S


def _means(samples: Array) -> Array:
    return 0.5 * (samples[:, :-1] + samples[:, 1:])
