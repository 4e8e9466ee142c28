"""State of the command arbiter."""

import enum
import math
from dataclasses import dataclass


class ArbiterMode(enum.Enum):
    """What the arbiter does."""

    FORWARDING = "forwarding"
    IDLE = "no source has commanded yet"
    STOPPING = "ramping to zero"
    STOPPED = "stopped until fresh commands"
    EMERGENCY_STOP = "emergency stop until released"
    LATCHED_STOP = "stopped until released"


class GuardAction(enum.Enum):
    """What the collision guard does with the commands."""

    OFF = "no collision guard"
    PASSING = "nothing in the way"
    SLOWING = "slowed for an obstacle"
    HOLDING = "held back by an obstacle"
    CRAWLING = "crawling beside an obstacle"
    BLIND = "held back without a fresh scan"


@dataclass(frozen=True, slots=True)
class ArbiterState:
    """What the command arbiter does, for reports.

    stamp_ns: the newest physical time known. source: who passes, or passed last. reason: of a stop, in words.
    guard, guard_reason: whether the collision guard limits commands, and why, in words. obstacle_m: way (m) along the
    commanded arc to the first contact, infinite if there is none in sight.
    """

    stamp_ns: int
    mode: ArbiterMode
    source: str
    reason: str
    guard: GuardAction = GuardAction.OFF
    guard_reason: str = ""
    obstacle_m: float = math.inf
