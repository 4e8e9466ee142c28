"""Slip estimate against the truth."""

import numpy as np

from tracked_report.channel import Array, Stamps
from tracked_report.metrics.sheet import MetricSheet, NotRecordedError
from tracked_report.run_record import RunRecord
from tracked_report.signals import root_mean_square

_COLUMNS = ("speed_mps", "yaw_rate_radps", "known")
_SURE = 0.999


def slip_errors(record: RunRecord) -> tuple[Stamps, Array]:
    """Stamps (n,) at which both slips are known, and estimate minus truth there (n, 2): m/s, rad/s.

    Raises NotRecordedError if either was not recorded, or nothing is known at the same time.
    """
    estimate = record.channel("slip").select(_COLUMNS).clean()
    truth = record.channel("truth_slip").select(_COLUMNS).clean()
    for name, channel in (("slip estimate", estimate), ("true slip", truth)):
        if not len(channel):
            raise NotRecordedError(f"no {name} was recorded")
    estimate = estimate.between(int(truth.stamps_ns[0]), int(truth.stamps_ns[-1]))
    true_slip = truth.at(estimate.stamps_ns)
    # Between a known and an unknown truth there is nothing to compare with.
    known = (estimate.column("known") > _SURE) & (true_slip[:, 2] > _SURE)
    if not known.any():
        raise NotRecordedError("slip was never known while there was truth to compare with")
    return estimate.stamps_ns[known], np.asarray(estimate.values[known, :2] - true_slip[known, :2])


def slip_metrics(record: RunRecord) -> MetricSheet:
    """RMS error of the slip estimate, both axes, over the instants at which it is known."""
    sheet = MetricSheet()
    _, errors = slip_errors(record)
    sheet.put("speed_rms_mps", root_mean_square(errors[:, 0]))
    sheet.put("yaw_rate_rms_radps", root_mean_square(errors[:, 1]))
    return sheet
