"""Time stamps as integer nanoseconds."""

NANOSECONDS_PER_SECOND = 1_000_000_000


def to_nanoseconds(seconds: float) -> int:
    """Nearest whole nanosecond of a time or duration given in seconds."""
    return round(seconds * NANOSECONDS_PER_SECOND)


def seconds_between(later_ns: int, earlier_ns: int) -> float:
    """``later_ns - earlier_ns`` in seconds; exact difference first, so epoch-sized stamps lose nothing."""
    return (later_ns - earlier_ns) / NANOSECONDS_PER_SECOND
