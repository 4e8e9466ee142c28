"""The n-th root of a determinant under LMIs, so that the volume of an ellipsoid can be maximised.

[X, Z; Z', diag Z] >= 0 with lower triangular Z has det X >= prod Z_kk, and a geometric mean is a tree of 2 x 2
matrices.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from robust_core.lmi.constraint import Constraint, blocks


@dataclass(frozen=True, slots=True)
class DeterminantRoot:
    """For X (size, size): unknowns Z (size, size) symmetric, root (1, 1), steps (count, 1, 1).

    Of Z the lower triangle counts.
    """

    size: int

    @property
    def width(self) -> int:
        """Leaves of the tree: the next power of two."""
        return 1 << (self.size - 1).bit_length()

    @property
    def steps(self) -> int:
        """Inner nodes of the tree below its top."""
        return max(self.width - 2, 0)

    def constraints(self, X: Any, Z: Any, root: Any, steps: Any) -> list[Constraint]:
        """root <= det(X)^(1/size); leaves beyond the size are the root itself."""
        lower = Z * np.tril(np.ones((self.size, self.size)))
        diagonal = Z * np.eye(self.size)
        block = blocks([[X, lower], [np.swapaxes(lower, -1, -2), diagonal]])
        level = [diagonal[..., k, k, None, None] for k in range(self.size)]
        level += [root] * (self.width - self.size)
        remaining = [steps[..., k, :, :] for k in range(self.steps)]
        means = []
        while len(level) > 1:
            pairs = list(zip(level[::2], level[1::2], strict=True))
            above = [remaining.pop(0) for _ in pairs] if len(pairs) > 1 else [root]
            means += [blocks([[a, mean], [mean, b]]) for (a, b), mean in zip(pairs, above, strict=True)]
            level = above
        found = [Constraint("det root", block[..., None, :, :])]
        if means:
            found.append(Constraint("geometric mean", np.stack(means, axis=-3)))
        return found


@lru_cache(maxsize=16)
def determinant_root(size: int) -> DeterminantRoot:
    """The constraints for matrices of one size."""
    return DeterminantRoot(size)
