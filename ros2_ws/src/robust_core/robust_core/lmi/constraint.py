"""Constraints: stacks of symmetric matrices, affine in the unknowns, that must be positive definite."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.rational import rational

NON_STRICT_WEIGHT = 2.0**-10
"""Share of the margin that a non-strict constraint gets: enough to survive rounding, too little to compete.

Asking a little of it does not change the sign of the best margin: where strict ones hold with a margin, the solution
can be moved a little until the others do too.
"""


@dataclass(frozen=True, slots=True)
class Constraint:
    """``matrices`` (..., K, n, n) > 0, or >= 0 unless ``strict``.

    ``sized`` marks the ones whose traces fix the size of the solution (P > 0, say): homogeneous inequalities have no
    scale of their own.
    """

    name: str
    matrices: Any
    strict: bool = True
    sized: bool = False

    @property
    def weight(self) -> float:
        """Share of the margin."""
        return 1.0 if self.strict else NON_STRICT_WEIGHT


def transpose(matrix: Any) -> Any:
    """Transpose of the last two axes."""
    return np.swapaxes(matrix, -1, -2)


def he(matrix: Any) -> Any:
    """M + M^T over the last two axes."""
    return matrix + np.swapaxes(matrix, -1, -2)


def blocks(rows: list[list[Any]]) -> Any:
    """Block matrix from blocks whose leading axes broadcast; None stands for a zero block.

    Every block row and column needs one block that tells its size.
    """
    columns = list(zip(*rows, strict=True))
    heights = [next(np.shape(block)[-2] for block in row if block is not None) for row in rows]
    widths = [next(np.shape(block)[-1] for block in column if block is not None) for column in columns]
    given = [np.asarray(block) for row in rows for block in row if block is not None]
    lead = np.broadcast_shapes(*(block.shape[:-2] for block in given))
    kind = np.result_type(*given)
    out = np.full((*lead, sum(heights), sum(widths)), rational(0) if kind.hasobject else 0.0, dtype=kind)
    top = 0
    for row, height in zip(rows, heights, strict=True):
        left = 0
        for block, width in zip(row, widths, strict=True):
            if block is not None:
                out[..., top : top + height, left : left + width] = block
            left += width
        top += height
    return out
