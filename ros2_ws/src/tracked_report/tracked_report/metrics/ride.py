"""Vertical acceleration of the body."""

from tracked_report.channel import Array, Stamps
from tracked_report.metrics.settings import MetricSettings
from tracked_report.metrics.sheet import MetricSheet, NotRecordedError
from tracked_report.run_record import RunRecord
from tracked_report.signals import low_pass, peak, root_mean_square, sample_rate


def vertical_acceleration(record: RunRecord, settings: MetricSettings) -> tuple[Stamps, Array]:
    """Stamps (n,) and low-passed vertical acceleration (n,), ns and m/s^2.

    Samples below twice the cut-off's rate are taken as they are (60 Hz means hold less than 30 Hz anyway).
    Raises NotRecordedError for fewer than two samples.
    """
    channel = record.channel("acceleration").clean()
    if len(channel) < 2:
        raise NotRecordedError("no vertical acceleration was recorded")
    rate = sample_rate(channel.seconds(int(channel.stamps_ns[0])))
    return channel.stamps_ns, low_pass(channel.column("vertical_mps2"), rate, settings.low_pass_hz)


def ride_metrics(record: RunRecord, settings: MetricSettings) -> MetricSheet:
    """Peak and RMS of the vertical acceleration over the whole record."""
    sheet = MetricSheet()
    _, samples = vertical_acceleration(record, settings)
    sheet.put("vertical_peak_mps2", peak(samples))
    sheet.put("vertical_rms_mps2", root_mean_square(samples))
    return sheet
