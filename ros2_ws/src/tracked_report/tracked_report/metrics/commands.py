"""How hard the commands work the base, and whether they keep the limits."""

import numpy as np

from tracked_report.channel import Channel
from tracked_report.metrics.sheet import MetricSheet, NotRecordedError
from tracked_report.run_record import CommandLimits, RunRecord
from tracked_report.signals import derivative, root_mean_square

_TOLERANCE = 1e-6


def command_metrics(record: RunRecord) -> MetricSheet:
    """RMS acceleration and jerk of the commands sent (both axes), and how many break the limits (5.2.5).

    Raises NotRecordedError for fewer than three commands.
    """
    sheet = MetricSheet()
    commands = record.channel("cmd_vel").clean()
    if len(commands) < 3:
        raise NotRecordedError("fewer than three commands were recorded")
    times = commands.seconds(int(commands.stamps_ns[0]))
    for column, name, unit in (("speed_mps", "", "mps"), ("yaw_rate_radps", "yaw_", "radps")):
        acceleration, middles = derivative(times, commands.column(column))
        jerk, _ = derivative(middles, acceleration)
        sheet.put(f"rms_{name}acceleration_{unit}2", root_mean_square(acceleration))
        sheet.put(f"rms_{name}jerk_{unit}3", root_mean_square(jerk))
    if record.meta.limits is None:
        sheet.missing["violations"] = "the record does not say the limits"
    else:
        sheet.put("violations", float(violations(commands, record.meta.limits)))
    return sheet


def violations(commands: Channel, limits: CommandLimits) -> int:
    """Number of commands outside the limits by more than 1e-6."""
    speed, yaw_rate = commands.column("speed_mps"), commands.column("yaw_rate_radps")
    outside = (
        (speed < limits.speed_min_mps - _TOLERANCE)
        | (speed > limits.speed_max_mps + _TOLERANCE)
        | (np.abs(yaw_rate) > limits.yaw_rate_max_radps + _TOLERANCE)
    )
    return int(outside.sum())
