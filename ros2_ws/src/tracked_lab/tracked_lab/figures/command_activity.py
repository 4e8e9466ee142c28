"""What the commands of a run do between two times."""

import numpy as np

from tracked_report.channel import Array
from tracked_report.plots.timeline import origin_ns, seconds_after
from tracked_report.run_record import RunRecord

_ROUNDING_S = 1e-6
"""Times of the same instant may differ by so much."""


def yaw_rates(record: RunRecord, channel: str, begin_s: float, end_s: float) -> tuple[Array, Array]:
    """Times (s, n) after the first reference point, in (begin_s, end_s], and commanded yaw rates (rad/s, n)."""
    rows = record.channel(channel).clean()
    times = seconds_after(rows.stamps_ns, origin_ns(record))
    inside = (times > begin_s + _ROUNDING_S) & (times <= end_s + _ROUNDING_S)
    return times[inside], rows.column("yaw_rate_radps")[inside]


def changes(record: RunRecord, begin_s: float, end_s: float) -> int:
    """How often the control layers asked for a new yaw rate."""
    _, asked = yaw_rates(record, "cmd_vel_nav", begin_s, end_s)
    return int(np.count_nonzero(np.diff(asked)))


def limit_stretch(record: RunRecord, begin_s: float, limit_radps: float) -> tuple[float, float]:
    """Times (s) of the first command sent after ``begin_s`` with a yaw rate at its limit, and of the next that is not.

    Raises
    ------
    ValueError: if the yaw rate is never at its limit, or stays there.
    """
    times, sent = yaw_rates(record, "cmd_vel", begin_s, np.inf)
    at_limit = np.abs(sent) >= limit_radps - 1e-6
    first = int(np.argmax(at_limit))
    after = first + int(np.argmin(at_limit[first:]))
    if not at_limit.any() or at_limit[after]:
        raise ValueError(f"no yaw rate is sent that reaches {limit_radps:g} rad/s after {begin_s:g} s and leaves it")
    return float(times[first]), float(times[after])


def compensation(record: RunRecord, begin_s: float, end_s: float) -> tuple[float, float]:
    """How the yaw rate sent beyond the upper layer's plan goes with the yaw rate that slip takes.

    Returns
    -------
    The correlation of the two, and the slope of the first over the second, (rad/s) per (rad/s). The plan's first
    inputs are joined by straight lines.
    """
    times, sent = yaw_rates(record, "cmd_vel", begin_s, end_s)
    plan_times, planned = yaw_rates(record, "upper_plan", begin_s - 1.0, end_s + 1.0)
    slip = record.channel("slip").clean()
    known = slip.rows(np.flatnonzero(slip.column("known") > 0.5))
    lost = -np.interp(times, seconds_after(known.stamps_ns, origin_ns(record)), known.column("yaw_rate_radps"))
    added = sent - np.interp(times, plan_times, planned)
    return float(np.corrcoef(lost, added)[0, 1]), float(np.polyfit(lost, added, 1)[0])
