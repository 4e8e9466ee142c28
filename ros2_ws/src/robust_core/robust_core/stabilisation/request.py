"""What a stabilising design is asked for."""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from robust_core.checks import finite_array, finite_number
from robust_core.errors import ArgumentError
from robust_core.rational import Floats
from robust_core.theorems.regions import Region

Objective = Literal["small gains", "small set", "large set"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Request:
    """Constraints that combine freely.

    decay: least rate of decay (1/s). region: where the frozen poles must lie. input_limit (r,): |u| that is never
    reached. box: {state index: bound}, or rows (k, n) with ``box_limit`` (k,), never left. start (p, n): points that
    the claim must cover; by convexity it covers their hull. objective: "small gains", or the "small set" or "large set"
    (trace, determinant) that is invariant; sets need an input limit or starts. digits: significant digits of the gains.
    reserve: share of the decay and of the limits that the design keeps for the proof.
    """

    decay: float = 0.0
    region: Region | None = None
    input_limit: Any = None
    box: Any = None
    box_limit: Any = None
    start: Any = None
    objective: Objective = "small gains"
    digits: int = 7
    reserve: float = 1e-3

    def __post_init__(self) -> None:
        finite_number("decay", self.decay, low=0.0)
        finite_number("reserve", self.reserve, low=0.0, high=0.5)
        finite_number("digits", self.digits, low=2, high=17)
        if self.objective not in ("small gains", "small set", "large set"):
            raise ArgumentError("objective", '"small gains", "small set" or "large set"', repr(self.objective))
        if self.objective == "large set" and self.input_limit is None and self.box is None:
            raise ArgumentError("objective", "bounded", "a large set without limits", "give input_limit or box")
        if self.objective == "small set" and self.start is None:
            raise ArgumentError("objective", "bounded from below", "a small set without starts", "give start")

    @property
    def limited(self) -> bool:
        """Whether an invariant ellipsoid of its own size is asked for."""
        return any(value is not None for value in (self.input_limit, self.box, self.start))

    def limits(self, states: int, inputs: int) -> dict[str, Floats]:
        """Checked arrays of the limits that were given: input_limit, box rows, box_limit, start.

        Raises
        ------
        ArgumentError: for another shape, an index that is no state, or limits that are not positive.
        """
        out: dict[str, Floats] = {}
        if self.input_limit is not None:
            out["input_limit"] = finite_array("input_limit", np.atleast_1d(self.input_limit), (inputs,))
        if isinstance(self.box, dict):
            if any(not 0 <= int(k) < states for k in self.box) or not self.box:
                raise ArgumentError("box", f"bounds of states 0..{states - 1}", repr(self.box))
            out["box"] = np.eye(states)[[int(k) for k in self.box]]
            out["box_limit"] = finite_array("box", list(self.box.values()), (None,))
        elif self.box is not None:
            out["box"] = finite_array("box", self.box, (None, states))
            out["box_limit"] = finite_array("box_limit", self.box_limit, (len(out["box"]),))
        if self.start is not None:
            out["start"] = finite_array("start", np.atleast_2d(self.start), (None, states))
        for name in ("input_limit", "box_limit"):
            if name in out and (out[name] <= 0.0).any():
                raise ArgumentError(name, "positive", str(out[name].tolist()))
        return out
