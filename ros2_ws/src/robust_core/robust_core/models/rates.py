"""Bounds on how fast the weights can change: phi_r, the largest rate of sigma_r over the box."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.checks import finite_array
from robust_core.errors import ArgumentError
from robust_core.rational import Floats


@dataclass(frozen=True, slots=True)
class RateBounds:
    """For every weight, an enclosure of phi_r = sup of its rate over the box (1/s).

    A theorem that holds at ``high`` holds at phi; one that is infeasible at ``low`` is infeasible at phi, because
    larger bounds ask for more. ``proven`` says that phi_r lies in between beyond doubt (interval arithmetic, or bounds
    that the user vouches for); sampled bounds support a verdict but prove none.
    """

    low: Floats
    high: Floats
    proven: bool

    def __post_init__(self) -> None:
        count = np.size(self.high)
        low, high = finite_array("low", self.low, (count,)), finite_array("high", self.high, (count,))
        if (low > high).any():
            raise ArgumentError("low", "at most high", f"{low.tolist()} and {high.tolist()}")
        if (high < 0.0).any():
            raise ArgumentError(
                "high",
                "non-negative (every weight stands still at the origin)",
                str(high.tolist()),
                "bound the whole box",
            )
        object.__setattr__(self, "low", np.maximum(low, 0.0))
        object.__setattr__(self, "high", high)

    @staticmethod
    def given(phi: Any) -> "RateBounds":
        """Bounds that the user vouches for: they count as proven."""
        values = finite_array("phi", phi, (None,))
        return RateBounds(values, values, proven=True)

    def to_json(self) -> dict[str, Any]:
        """Plain data with exact floats."""
        return {
            "low": [v.hex() for v in self.low.tolist()],
            "high": [v.hex() for v in self.high.tolist()],
            "proven": self.proven,
        }

    @staticmethod
    def from_json(data: Any) -> "RateBounds":
        """Bounds from what :meth:`to_json` gave."""
        low, high = (np.array([float.fromhex(v) for v in data[key]]) for key in ("low", "high"))
        return RateBounds(low, high, proven=bool(data["proven"]))
