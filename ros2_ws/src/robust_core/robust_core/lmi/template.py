"""Rows of a theorem's margin problem as an affine function of the model's numbers.

The formulas are evaluated once per unit vector of the data; after that a model costs one product instead of all the
formulas. Only for theorems that say that they are affine in their data, and checked on random data when it is made.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from robust_core.lmi.coefficients import Family
from robust_core.lmi.layout import Layout, Rows
from robust_core.lmi.scaling import SPREAD, SPREAD_OF_ALL
from robust_core.rational import Floats

_LARGEST = 4_000_000


@dataclass(frozen=True, slots=True)
class Template:
    """``table`` (numbers + 1, cells) gives the columns of all unknowns; ``frame`` holds what data does not change."""

    keys: tuple[str, ...]
    constants: Mapping[str, Any]
    layout: Layout
    names: tuple[str, ...]
    sized: tuple[bool, ...]
    table: Floats
    frame: Rows
    total: float

    @staticmethod
    def of(
        keys: Sequence[str], data: Mapping[str, Any], families: Callable[[Mapping[str, Any]], Sequence[Family]]
    ) -> "Template | None":
        """A template, or None where it would be too large or the formulas are not affine in ``data[keys]``."""
        shapes = [np.shape(data[key]) for key in keys]
        count = sum(int(np.prod(shape)) for shape in shapes)
        first = families(data)
        layout = Layout.of(first, with_margin=True, with_size=True)
        if (count + 1) * layout.count * layout.size > _LARGEST:
            return None

        def linear(numbers: Floats) -> Floats:
            parts, start = {}, 0
            for key, shape in zip(keys, shapes, strict=True):
                stop = start + int(np.prod(shape))
                parts[key] = numbers[start:stop].reshape(shape)
                start = stop
            return layout.rows(families({**data, **parts})).columns[: layout.size]

        base = linear(np.zeros(count))
        table = np.stack([base, *(linear(unit) - base for unit in np.eye(count))]).reshape(count + 1, -1)
        test = np.random.default_rng(0).uniform(1.0, 2.0, count)
        if not np.allclose(np.append(1.0, test) @ table, linear(test).ravel(), rtol=1e-9, atol=1e-9):
            return None
        sized = tuple(family.sized for family in first)
        frame = layout.rows([replace(family, linear=0.0 * family.linear) for family in first])
        total = float(sum(c.blocks * c.size for c, one in zip(layout.cones, sized, strict=True) if one))
        constants = {key: value for key, value in data.items() if key not in keys}
        return Template(
            tuple(keys), constants, layout, tuple(family.name for family in first), sized, table, frame, total
        )

    def rows(self, data: Mapping[str, Any]) -> Rows | None:
        """Rows for a model's data; None where they need to be equilibrated, or other data than ``keys`` differ."""
        if not all(np.array_equal(data[key], value) for key, value in self.constants.items()):
            return None
        numbers = np.concatenate([[1.0], *(np.ravel(data[key]) for key in self.keys)])
        columns = self.frame.columns.copy()
        inner = columns[: self.layout.size]
        inner[:] = (numbers @ self.table).reshape(inner.shape)
        magnitudes = np.abs(inner[:, 1:])
        by_unknown, by_row = magnitudes.max(axis=1), magnitudes.max(axis=0)
        smallest = min(by_unknown.min(), by_row[by_row > 0.0].min(initial=np.inf))
        least = magnitudes[magnitudes > 0.0].min(initial=np.inf)
        if not by_unknown.max() <= min(SPREAD * smallest, SPREAD_OF_ALL * least):
            return None
        right = self.frame.right.copy()
        right[0] = self.total
        for cone, span, sized in zip(self.layout.cones, self.layout.spans, self.sized, strict=True):
            if sized:
                inner[:, 0] -= cone.traces(inner[:, span])
        return Rows(columns, right)
