"""What can be said about a claim; never a bare boolean."""

from enum import Enum


class Verdict(Enum):
    """Outcome of asking a theorem about a model.

    ``PROVEN``: the conditions hold, checked in exact arithmetic. ``SUPPORTED``: they hold in floating point, or exactly
    but with rate bounds that are only sampled. ``INFEASIBLE``: proven to have no solution, by a dual certificate in
    exact arithmetic; the theorem is silent about the system then. ``UNDECIDED``: none of these.
    """

    PROVEN = "proven"
    SUPPORTED = "supported"
    INFEASIBLE = "infeasible"
    UNDECIDED = "undecided"

    def __bool__(self) -> bool:
        raise TypeError("a verdict is not a boolean: compare it, for example with Verdict.PROVEN")
