"""Solver times, loop periods and latency."""

from dataclasses import dataclass

import numpy as np

from tracked_report.channel import Array, Channel
from tracked_report.metrics.sheet import MetricSheet, NotRecordedError
from tracked_report.run_record import RunRecord
from tracked_report.signals import percentile

LAYERS = ("upper", "lower")


@dataclass(frozen=True, slots=True)
class Loop:
    """A periodic stream: periods on message stamps and on the wall clock (ms), and instants left out."""

    stamp_periods_ms: Array
    wall_periods_ms: Array
    missed: int


def loop(channel: Channel) -> Loop:
    """Periods of a channel. The nominal period is the median on stamps; a longer gap counts what it left out.

    Raises NotRecordedError for fewer than two rows.
    """
    if len(channel) < 2:
        raise NotRecordedError("fewer than two ticks were recorded")
    stamps = np.diff(np.unique(channel.stamps_ns)).astype(np.float64) * 1e-6
    walls = np.diff(channel.arrivals_s) * 1e3
    nominal = float(np.median(stamps)) if len(stamps) else 1.0
    missed = int(np.sum(np.maximum(np.rint(stamps / nominal) - 1.0, 0.0)))
    return Loop(stamps, walls[np.isfinite(walls)], missed)


def solver_metrics(record: RunRecord, layer: str) -> MetricSheet:
    """Thread CPU time per tick of one layer (ms) and how many ticks did not come from a converged solution."""
    status = record.channel(f"{layer}_status")
    if not len(status):
        raise NotRecordedError(f"no status of the {layer} layer was recorded")
    sheet = MetricSheet()
    times = status.column("cpu_time_s") * 1e3
    finite = times[np.isfinite(times)]
    sheet.put(f"{layer}_median_ms", percentile(finite, 50.0))
    sheet.put(f"{layer}_p99_ms", percentile(finite, 99.0))
    sheet.put(f"{layer}_not_converged", float(np.sum(status.column("ok") < 0.5)))
    return sheet


def loop_metrics(record: RunRecord, channel: str, name: str) -> MetricSheet:
    """Wall-clock period (where arrivals were recorded) and share of instants left out."""
    sheet = MetricSheet()
    ticks = loop(record.channel(channel))
    sheet.put(f"{name}_missed_percent", 100.0 * ticks.missed / (ticks.missed + len(ticks.stamp_periods_ms) + 1))
    reason = "arrival times were not recorded (run in process)"
    sheet.put(f"{name}_period_median_ms", percentile(ticks.wall_periods_ms, 50.0), reason)
    sheet.put(f"{name}_period_p99_ms", percentile(ticks.wall_periods_ms, 99.0), reason)
    return sheet


def latencies_ms(record: RunRecord) -> Array:
    """Wall time from the arrival of each odometry to that of the command answering it (n,), ms."""
    odometry, commands = record.channel("odometry"), record.channel("cmd_vel")
    _, at_odometry, at_command = np.intersect1d(odometry.stamps_ns, commands.stamps_ns, return_indices=True)
    waits = (commands.arrivals_s[at_command] - odometry.arrivals_s[at_odometry]) * 1e3
    return np.asarray(waits[np.isfinite(waits)])


def latency_metrics(record: RunRecord) -> MetricSheet:
    """Odometry to command. Raises NotRecordedError if no pair of arrivals was recorded."""
    waits = latencies_ms(record)
    if not len(waits):
        raise NotRecordedError("no command and the odometry it answers have arrival times (run in process)")
    sheet = MetricSheet()
    sheet.put("odometry_to_command_median_ms", percentile(waits, 50.0))
    sheet.put("odometry_to_command_p99_ms", percentile(waits, 99.0))
    return sheet
