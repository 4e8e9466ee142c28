"""Products of simplices: which weights sum to what, and the vertices that are really attained.

The thesis lets sigma range over the simplex of all m weights. In its examples weights come in pairs that sum to 1/2
(erratum 2.1.4), so the vertices A_r are never attained; the attained ones mix one member of each group.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.errors import ArgumentError
from robust_core.rational import Exact, exact_array, rational


@dataclass(frozen=True, slots=True)
class Simplices:
    """Groups of weights; the weights of group g are non-negative and sum to ``totals[g]``.

    ``groups`` partition 0..m-1, ``totals`` are exact numbers that sum to 1.
    """

    groups: tuple[tuple[int, ...], ...]
    totals: tuple[Any, ...]

    @staticmethod
    def of(
        count: int, groups: Sequence[Sequence[int]] | None = None, totals: Sequence[Any] | None = None
    ) -> "Simplices":
        """Checked groups over ``count`` weights: one simplex unless given, equal totals unless given.

        >>> Simplices.of(4, [(0, 1), (2, 3)]).choices()
        ((0, 2), (0, 3), (1, 2), (1, 3))

        Raises
        ------
        ArgumentError: if the groups are no partition, or the totals not positive with sum 1.
        """
        if count < 1:
            raise ArgumentError("count", "at least one weight", str(count))
        chosen = tuple(tuple(int(k) for k in group) for group in (groups or [range(count)]))
        flat = sorted(k for group in chosen for k in group)
        if flat != list(range(count)) or not all(chosen):
            raise ArgumentError("groups", f"a partition of the weights 0..{count - 1}", repr(chosen))
        shares = [rational(1) / len(chosen)] * len(chosen) if totals is None else [rational(v) for v in totals]
        if len(shares) != len(chosen) or not all(v > 0 for v in shares) or sum(shares) != 1:
            got = [str(v) for v in shares]
            raise ArgumentError(
                "totals", "one positive number per group, with sum 1", str(got), "give exact ones, as '1/3'"
            )
        return Simplices(chosen, tuple(shares))

    @property
    def count(self) -> int:
        """Number of weights m."""
        return sum(len(group) for group in self.groups)

    def choices(self) -> tuple[tuple[int, ...], ...]:
        """One member of every group, in all combinations: the attained vertices."""
        return tuple(itertools.product(*self.groups))

    def mixing(self) -> Exact:
        """Exact matrix (vertices, m): row k holds the weights at attained vertex k."""
        rows = np.full((len(self.choices()), self.count), rational(0), dtype=object)
        for row, choice in enumerate(self.choices()):
            for total, member in zip(self.totals, choice, strict=True):
                rows[row, member] = total
        return rows

    def to_json(self) -> dict[str, Any]:
        """Plain data; :meth:`from_json` reads it back."""
        return {"groups": [list(group) for group in self.groups], "totals": [str(v) for v in self.totals]}

    @staticmethod
    def from_json(data: Any) -> "Simplices":
        """Groups from what :meth:`to_json` gave."""
        groups = data["groups"]
        return Simplices.of(sum(len(g) for g in groups), groups, [exact_array(v).item() for v in data["totals"]])
