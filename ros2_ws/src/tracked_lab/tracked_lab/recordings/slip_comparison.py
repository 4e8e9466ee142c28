"""The slip law against what a user would take instead, on windows of a real vehicle."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tracked_lab.recordings.drive_windows import DriveWindows
from tracked_lab.recordings.recording_file import Array
from tracked_lab.recordings.window_motion import Motion, slip_motion, true_motion, wheel_motion
from tracked_localization import SlipSettings

FOLDS = 5
_RESAMPLES = 2000


@dataclass(frozen=True, slots=True)
class Method:
    """One way to reckon: distance (n,) of each window's end from where ICP saw it. fitted: numbers it was given by
    the other folds, 0 for none."""

    key: str
    name: str
    fitted: int
    errors_m: Array

    @property
    def rms_m(self) -> float:
        """Root mean square over the windows."""
        return float(np.sqrt(np.mean(self.errors_m**2)))

    @property
    def median_m(self) -> float:
        """Median over the windows."""
        return float(np.median(self.errors_m))

    def interval_m(self, seed: int) -> tuple[float, float]:
        """95 % interval of the RMS, by resampling the windows."""
        random = np.random.default_rng(seed)
        chosen = random.integers(len(self.errors_m), size=(_RESAMPLES, len(self.errors_m)))
        low, high = np.percentile(np.sqrt(np.mean(self.errors_m[chosen] ** 2, axis=1)), [2.5, 97.5])
        return float(low), float(high)


def compare(windows: DriveWindows, settings: SlipSettings) -> list[Method]:
    """All methods, the plainest first; those that fit numbers predict each fifth of the windows from the others."""
    truth, wheels = true_motion(windows), wheel_motion(windows, settings.gauge_m)
    slip, none = slip_motion(windows, settings), np.zeros_like(truth.turn_rad)
    turn = truth.turn_rad
    multiplied = Motion(cross_fitted([wheels.forward_m], truth.forward_m), none, cross_fitted([wheels.turn_rad], turn))
    fitted = Motion(
        cross_fitted([wheels.forward_m, slip], truth.forward_m), cross_fitted([turn], truth.sideways_m), turn
    )
    motions = [
        ("nominal", "wheels alone, nominal geometry", 0, wheels),
        ("multiplier", "wheels, best constant multipliers of speed and yaw rate", 2, multiplied),
        ("yaw_rate", "wheels and yaw rate", 0, Motion(wheels.forward_m, none, turn)),
        ("slip_law", "slip law: wheels, yaw rate and (5.2.8)-(5.2.11)", 0, Motion(wheels.forward_m + slip, none, turn)),
        ("slip_law_fitted", "slip law, fitted scales and sideways motion per yaw rate", 3, fitted),
    ]
    return [
        Method(key, name, count, np.linalg.norm(motion.end_m(windows) - windows.end_m, axis=1))
        for key, name, count, motion in motions
    ]


def cross_fitted(features: Sequence[Array], target: Array) -> Array:
    """Sum of features, scaled so that their totals over a window fit the target's; each fold by the other folds.

    features, target: (n, m). The folds are consecutive, since neighbouring windows are alike.
    """
    totals, wanted = np.stack([feature.sum(axis=1) for feature in features], axis=1), target.sum(axis=1)
    fold = np.arange(len(target)) * FOLDS // len(target)
    predicted = np.empty_like(target)
    for number in range(FOLDS):
        inside = fold == number
        scales = np.linalg.lstsq(totals[~inside], wanted[~inside], rcond=None)[0]
        predicted[inside] = sum(scale * feature[inside] for scale, feature in zip(scales, features, strict=True))
    return predicted
