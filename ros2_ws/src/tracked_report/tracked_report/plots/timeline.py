"""A common time axis for the pictures of a run."""

import numpy as np

from tracked_report.channel import Array, Channel, Stamps
from tracked_report.metrics.sheet import NotRecordedError
from tracked_report.run_record import RunRecord


def origin_ns(record: RunRecord) -> int:
    """Time zero of the pictures: the first reference point, else the first stamp of anything.

    Raises NotRecordedError if nothing at all was recorded.
    """
    reference = record.channel("reference").clean()
    if len(reference):
        return int(reference.stamps_ns[0])
    firsts = [int(channel.stamps_ns.min()) for channel in record.channels.values() if len(channel)]
    if not firsts:
        raise NotRecordedError("nothing was recorded")
    return min(firsts)


def seconds_after(stamps_ns: Stamps, origin: int) -> Array:
    """Stamps as seconds after ``origin`` (n,)."""
    return np.asarray((stamps_ns - origin) * 1e-9)


def series(record: RunRecord, channel: str, column: str) -> tuple[Array, Array]:
    """Times (s) and values of one column with gaps as NaN, so that a line breaks where samples are missing.

    Raises NotRecordedError if the channel is empty.
    """
    rows = record.channel(channel)
    if not len(rows):
        raise NotRecordedError(f"channel {channel} was not recorded")
    return with_gaps(rows, column, origin_ns(record))


def with_gaps(rows: Channel, column: str, origin: int) -> tuple[Array, Array]:
    """Times and values of one column; a NaN is put into every gap longer than 3.5 typical steps."""
    order = np.argsort(rows.stamps_ns, kind="stable")
    times, values = seconds_after(rows.stamps_ns[order], origin), rows.column(column)[order]
    if len(times) < 3:
        return times, values
    steps = np.diff(times)
    gaps = np.flatnonzero(steps > 3.5 * max(float(np.median(steps)), 1e-9))
    return np.insert(times, gaps + 1, times[gaps]), np.insert(values, gaps + 1, np.nan)
