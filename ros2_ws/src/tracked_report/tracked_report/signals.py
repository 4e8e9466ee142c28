"""Figures of one signal: peak to peak, root mean square, low-pass, differences."""

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def peak_to_peak(samples: Array) -> float:
    """Largest minus smallest sample, (5.3.1); NaN if there is none."""
    return float(np.max(samples) - np.min(samples)) if len(samples) else math.nan


def root_mean_square(samples: Array) -> float:
    """Square root of the mean square, (5.3.2); NaN if there is no sample.

    Scaled by the largest sample, so that neither tiny nor huge samples are lost in the squares.
    """
    largest = peak(samples)
    if not math.isfinite(largest) or largest == 0.0:
        return largest
    return largest * math.sqrt(float(np.mean((samples / largest) ** 2)))


def peak(samples: Array) -> float:
    """Largest absolute sample; NaN if there is none."""
    return float(np.max(np.abs(samples))) if len(samples) else math.nan


def percentile(samples: Array, percent: float) -> float:
    """Percentile, linear between samples; NaN if there is none."""
    return float(np.percentile(samples, percent)) if len(samples) else math.nan


def sample_rate(times_s: Array) -> float:
    """Samples per second from the median step of (n,) increasing times; NaN for fewer than two samples."""
    if len(times_s) < 2:
        return math.nan
    step = float(np.median(np.diff(times_s)))
    return 1.0 / step if step > 0.0 else math.nan


def derivative(times_s: Array, samples: Array) -> tuple[Array, Array]:
    """Difference quotients (n-1,) and the times in the middle of each step (n-1,)."""
    return np.diff(samples) / np.diff(times_s), (times_s[1:] + times_s[:-1]) / 2.0


def low_pass(samples: Array, rate_hz: float, cutoff_hz: float) -> Array:
    """Causal second-order Butterworth low-pass of (n,) evenly spaced samples, started at rest on the first.

    A cut-off at or above half the sample rate removes nothing: the samples come back as they are.
    Raises ValueError unless both frequencies are positive and finite.
    """
    if not (math.isfinite(rate_hz) and math.isfinite(cutoff_hz) and rate_hz > 0.0 and cutoff_hz > 0.0):
        raise ValueError(f"rate_hz and cutoff_hz must be positive, got {rate_hz!r} and {cutoff_hz!r}")
    if cutoff_hz >= rate_hz / 2.0 or len(samples) == 0:
        return np.array(samples, dtype=np.float64)
    # Bilinear transform with pre-warped cut-off of 1 / (s^2 + sqrt(2) s + 1).
    warped = math.tan(math.pi * cutoff_hz / rate_hz)
    scale = 1.0 / (1.0 + math.sqrt(2.0) * warped + warped**2)
    b0 = warped**2 * scale
    a1, a2 = 2.0 * (warped**2 - 1.0) * scale, (1.0 - math.sqrt(2.0) * warped + warped**2) * scale
    out = np.empty(len(samples))
    x1 = x2 = y1 = y2 = float(samples[0])
    for index, x0 in enumerate(np.asarray(samples, dtype=np.float64).tolist()):
        y0 = b0 * (x0 + 2.0 * x1 + x2) - a1 * y1 - a2 * y2
        out[index] = y0
        x1, x2, y1, y2 = x0, x1, y0, y1
    return out
