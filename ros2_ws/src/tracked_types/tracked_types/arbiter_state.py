"""State of the command arbiter."""

import enum
from dataclasses import dataclass


class ArbiterMode(enum.Enum):
    """What the arbiter does."""

    FORWARDING = "forwarding"
    IDLE = "no source has commanded yet"
    STOPPING = "ramping to zero"
    STOPPED = "stopped until fresh commands"
    EMERGENCY_STOP = "emergency stop until released"


@dataclass(frozen=True, slots=True)
class ArbiterState:
    """What the command arbiter does, for reports.

    stamp_ns: the newest physical time known. source: who passes, or passed last. reason: of a stop, in words.
    """

    stamp_ns: int
    mode: ArbiterMode
    source: str
    reason: str
