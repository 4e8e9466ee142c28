"""A channel of a run: stamped rows of numbers."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_types import NANOSECONDS_PER_SECOND, angle_difference, wrap_angle

Array = NDArray[np.float64]
Stamps = NDArray[np.int64]
ANGLE_SUFFIX = "yaw_rad"


@dataclass(frozen=True, slots=True)
class Channel:
    """Rows as they were recorded: possibly none, possibly with NaN, possibly out of order.

    columns: names with unit suffix; stamps_ns: (n,) message stamps; values: (n, columns);
    arrivals_s: (n,) monotonic wall time at which each row arrived, NaN where rows were made in process.
    """

    columns: tuple[str, ...]
    stamps_ns: Stamps
    values: Array
    arrivals_s: Array

    def __post_init__(self) -> None:
        count = len(self.stamps_ns)
        if self.values.shape != (count, len(self.columns)) or self.arrivals_s.shape != (count,):
            raise ValueError(
                f"{count} stamps need values ({count}, {len(self.columns)}) and arrivals ({count},), "
                f"got {self.values.shape} and {self.arrivals_s.shape}"
            )
        if len(set(self.columns)) != len(self.columns):
            raise ValueError(f"columns must differ, got {', '.join(self.columns)}")

    @classmethod
    def empty(cls, columns: tuple[str, ...]) -> "Channel":
        """A channel in which nothing was recorded."""
        return cls(columns, np.zeros(0, np.int64), np.zeros((0, len(columns))), np.zeros(0))

    def __len__(self) -> int:
        return len(self.stamps_ns)

    def column(self, name: str) -> Array:
        """One column (n,); an unknown name raises KeyError that lists the known ones."""
        if name not in self.columns:
            raise KeyError(f"no column {name!r}; there are {', '.join(self.columns)}")
        return np.asarray(self.values[:, self.columns.index(name)])

    def select(self, columns: tuple[str, ...]) -> "Channel":
        """Some of the columns, in the given order; unknown names raise as in `column`."""
        values = np.column_stack([self.column(name) for name in columns])
        return Channel(columns, self.stamps_ns, values, self.arrivals_s)

    def seconds(self, origin_ns: int = 0) -> Array:
        """Stamps as seconds after ``origin_ns`` (n,)."""
        return np.asarray((self.stamps_ns - origin_ns) / NANOSECONDS_PER_SECOND)

    def rows(self, chosen: NDArray[np.bool_] | NDArray[np.intp]) -> "Channel":
        """The rows that a mask or an index array chooses."""
        return Channel(self.columns, self.stamps_ns[chosen], self.values[chosen], self.arrivals_s[chosen])

    def between(self, start_ns: int, end_ns: int) -> "Channel":
        """Rows with stamps in [start_ns, end_ns]."""
        return self.rows(np.flatnonzero((self.stamps_ns >= start_ns) & (self.stamps_ns <= end_ns)))

    def clean(self) -> "Channel":
        """Only finite rows, in order of stamps; of rows with equal stamps the one recorded last."""
        finite = self.rows(np.flatnonzero(np.isfinite(self.values).all(axis=1)))
        # np.unique keeps the first of equal stamps, hence the reversal.
        stamps, first = np.unique(finite.stamps_ns[::-1], return_index=True)
        return finite.rows(len(finite) - 1 - first) if len(stamps) else finite

    def at(self, stamps_ns: Stamps) -> Array:
        """Values (m, columns) at other stamps: linear in between, headings along the shorter arc, ends held.

        Raises ValueError if no finite row was recorded.
        """
        known = self.clean()
        if not len(known):
            raise ValueError("nothing to interpolate: the channel has no finite row")
        if len(known) == 1:
            return np.repeat(known.values, len(stamps_ns), axis=0)
        times, query = known.seconds(int(known.stamps_ns[0])), (stamps_ns - known.stamps_ns[0]) / NANOSECONDS_PER_SECOND
        lower = np.clip(np.searchsorted(times, query, side="right") - 1, 0, len(times) - 2)
        weight = np.clip((query - times[lower]) / (times[lower + 1] - times[lower]), 0.0, 1.0)[:, None]
        step = known.values[lower + 1] - known.values[lower]
        angles = [index for index, name in enumerate(self.columns) if name.endswith(ANGLE_SUFFIX)]
        step[:, angles] = angle_difference(known.values[lower + 1][:, angles], known.values[lower][:, angles])
        values = known.values[lower] + weight * step
        values[:, angles] = wrap_angle(values[:, angles])
        return np.asarray(values)
