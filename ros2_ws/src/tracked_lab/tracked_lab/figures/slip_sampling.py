"""Slip as a slower sampling would have measured it, from the record of a fast one."""

from dataclasses import dataclass

import numpy as np

from tracked_report.channel import Array, Channel
from tracked_report.plots.timeline import origin_ns, seconds_after
from tracked_report.run_record import RunRecord


@dataclass(frozen=True, slots=True)
class MeasuredSlip:
    """Means over each period of measuring, known at the period's end; all (n,).

    times_s: ends of the periods, after the first reference point. slip_radps: yaw rate of the ground less that of the
    belts. left_mps, right_mps: belts. Unknown is NaN.
    """

    times_s: Array
    slip_radps: Array
    left_mps: Array
    right_mps: Array

    def ratios(self, gauge_m: float, slowest_mps: float) -> tuple[Array, Array]:
        """Slip ratios of the left and right track (5.2.9), (5.2.10); NaN where both belts together are slower.

        ``slowest_mps`` bounds the denominator, whose smallness multiplies the noise without limit (erratum 5.2.9).
        """
        left, right = self.left_mps, self.right_mps
        same_way = np.sign(left * right)
        lost = -gauge_m * self.slip_radps
        sums = right + left * same_way, left + right * same_way
        with np.errstate(divide="ignore", invalid="ignore"):
            right_ratio, left_ratio = (
                np.where(np.abs(total) >= slowest_mps, sign * lost / total, np.nan)
                for sign, total in zip((1.0, -1.0), sums, strict=True)
            )
        return left_ratio, right_ratio


def measured_slip(record: RunRecord, fewer: int = 1) -> MeasuredSlip:
    """Slip that was measured ``fewer`` times less often: gyro and belts averaged over that many periods."""
    slip, tracks = record.channel("slip"), record.channel("tracks")
    belts = tracks.select(("left_speed_mps", "right_speed_mps")).at(slip.stamps_ns)
    columns = np.column_stack([_slip(slip), belts])
    whole = len(columns) // fewer * fewer
    means = columns[:whole].reshape(-1, fewer, 3).mean(axis=1)
    times = seconds_after(slip.stamps_ns[fewer - 1 : whole : fewer], origin_ns(record))
    return MeasuredSlip(times, *means.T)


def true_slip(record: RunRecord) -> tuple[Array, Array]:
    """Times (s, n) and true slip yaw rate (rad/s, n)."""
    truth = record.channel("truth_slip")
    return seconds_after(truth.stamps_ns, origin_ns(record)), _slip(truth)


def held(measured: MeasuredSlip, times_s: Array) -> Array:
    """The newest slip yaw rate that was known at each time; NaN before the first."""
    # Stamps of the same instant may differ by a rounding.
    index = np.searchsorted(measured.times_s, times_s + 1e-6, side="right") - 1
    return np.where(index >= 0, measured.slip_radps[np.maximum(index, 0)], np.nan)


def _slip(channel: Channel) -> Array:
    return np.where(channel.column("known") > 0.5, channel.column("yaw_rate_radps"), np.nan)
