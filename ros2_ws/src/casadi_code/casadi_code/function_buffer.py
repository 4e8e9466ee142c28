"""Calls of a CasADi function without copies of its arguments."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class FunctionBuffer:
    """Arrays that a CasADi function reads from and writes to in place.

    A call through numpy arguments costs 50 us, one through these buffers 0.2 us. CasADi stores matrices
    by columns and takes one-dimensional buffers only, so each array here has the shape of the transposed
    matrix (columns first): a table over the horizon is one row per stage. Scalars have shape (1, 1).

    Not to be used with functions that embed the `hpipm` or `fatrop` QP solvers, which return wrong
    numbers from the second buffered call on.
    """

    def __init__(self, function: Any) -> None:
        self._function = function
        self._buffer, self._call = function.buffer()
        self.inputs = {name: _table(function.size_in(name)) for name in function.name_in()}
        self.outputs = {name: _table(function.size_out(name)) for name in function.name_out()}
        self._views = [table.reshape(-1).data for table in (*self.inputs.values(), *self.outputs.values())]
        for index, view in enumerate(self._views[: len(self.inputs)]):
            self._buffer.set_arg(index, view)
        for index, view in enumerate(self._views[len(self.inputs) :]):
            self._buffer.set_res(index, view)

    def call(self) -> None:
        """Evaluate the function on the inputs as they are now.

        Raises
        ------
        RuntimeError: if the function reports an error.
        """
        self._call()
        if self._buffer.ret():
            raise RuntimeError(f"{self._function.name()} failed with code {self._buffer.ret()}")


def _table(size: tuple[int, int]) -> Array:
    rows, columns = size
    return np.zeros((columns, rows))
