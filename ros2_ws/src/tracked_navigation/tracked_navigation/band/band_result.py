"""What an update of the band brings about."""

from dataclasses import dataclass

from tracked_types import Trajectory

BAND, SLOWER, OTHER_SIDE, STOP, ARRIVED, NONE = "band", "slower", "other side", "stop", "arrived", "none"


@dataclass(frozen=True, slots=True)
class Candidate:
    """One band that was tried. way: past what and by which side. cost: the lower the better. reason: why it may not be
    driven, in words, empty if it may."""

    way: str
    cost: float
    reason: str


@dataclass(frozen=True, slots=True)
class BandResult:
    """trajectory: to be driven from now on, checked; None only if the robot's own state makes no sense.

    kind: band (as planned), slower (at half the speed), other side (not by the way that was followed), stop (brakes to
    rest), arrived (stands at the goal), none. reason: in words, why it is not simply a band to the goal. way: past what
    and by which side it leads. clearance_m: least room along it, inf if there is nothing within 0.3 m. unavoidable: not
    even braking keeps the robot from a contact. candidates: everything that was tried.
    """

    trajectory: Trajectory | None
    kind: str
    reason: str
    way: str = ""
    clearance_m: float = float("inf")
    unavoidable: bool = False
    candidates: tuple[Candidate, ...] = ()
