"""Outcome of one controller tick."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SolverStatus:
    """What one tick of a control layer did, for diagnostics and reports.

    ok: the command comes from a converged solution; otherwise ``reason`` names the cause in words.
    cpu_time_s: thread CPU time of the tick, argument marshalling included.
    """

    stamp_ns: int
    layer: str
    ok: bool
    reason: str
    iterations: int
    cost: float
    cpu_time_s: float
