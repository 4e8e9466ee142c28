"""Medians of pairs with bootstrap intervals: what a comparison over seeds says, and how surely."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_RESAMPLES, _CONFIDENCE = 4000, 0.95


@dataclass(frozen=True, slots=True)
class Interval:
    """Median of ``count`` values and its 95 % bootstrap interval."""

    median: float
    low: float
    high: float
    count: int


def median_interval(values: Array, seed: int = 0) -> Interval:
    """Median of values (n,) with the percentile interval of resampled medians; values that are not finite are left out.

    Raises
    ------
    ValueError: if no value is finite.
    """
    kept = values[np.isfinite(values)]
    if not len(kept):
        raise ValueError("no finite value to take a median of")
    return _interval(kept, seed)


def latest_median(times_s: Array, seed: int = 0) -> Interval | None:
    """As `median_interval` of times (n,) of which some are infinite, since what is waited for never came; they count.

    None if the median is infinite; the interval may be, upwards. NaN is left out.
    """
    kept = times_s[~np.isnan(times_s)]
    if not len(kept) or not np.isfinite(np.median(kept)):
        return None
    return _interval(kept, seed)


def _interval(kept: Array, seed: int) -> Interval:
    draws = np.random.default_rng(seed).integers(0, len(kept), (_RESAMPLES, len(kept)))
    medians = np.median(kept[draws], axis=1)
    # Not interpolated: some may be infinite.
    low, high = np.sort(medians)[
        np.rint([(_RESAMPLES - 1) * 0.5 * (1.0 + side * _CONFIDENCE) for side in (-1, 1)]).astype(int)
    ]
    return Interval(float(np.median(kept)), float(low), float(high), len(kept))


def reduction_percent(baseline: Array, other: Array, seed: int = 0) -> Interval:
    """By how many percent ``other`` is lower than ``baseline`` (n,), pair by pair.

    Raises
    ------
    ValueError: if they are not of one length, or no pair is finite with a baseline above zero.
    """
    if baseline.shape != other.shape:
        raise ValueError(f"pairs are needed, got {baseline.shape} and {other.shape}")
    with np.errstate(divide="ignore", invalid="ignore"):
        reductions = 100.0 * (1.0 - other / baseline)
    return median_interval(np.where(baseline > 0.0, reductions, np.nan), seed)
