"""Bounds phi_r on the rates of the weights over a whole box, for one or many sets of parameters."""

from typing import Any

import numpy as np

from robust_core.errors import ArgumentError, RateError
from robust_core.models import RateBounds
from robust_core.rational import Floats
from robust_core.symbolic.packages import casadi_module
from robust_core.symbolic.supremum import Supremum

_SAMPLES = 60_000


class RateMap:
    """Rates sigma_r' = c_r0(v) + sum_k p_k c_rk(v), affine in the parameters p.

    That makes maps cheap: interval arithmetic is done once for all points, and per point only sums remain.

    Raises
    ------
    RateError: if the rates are not affine in the parameters; substitute numbers for them then.
    """

    def __init__(self, rates: Any, variables: Any, parameters: Any, low: Floats, high: Floats) -> None:
        casadi = casadi_module()
        self.low, self.high, self.variables = low, high, variables
        self.count, self.parameters = int(rates.numel()), int(parameters.numel())
        slopes = casadi.jacobian(rates, parameters)
        if self.parameters and casadi.depends_on(slopes, parameters):
            raise RateError("rates are not affine in the parameters: substitute numbers and bound them point by point")
        constant = casadi.substitute(rates, parameters, casadi.DM.zeros(self.parameters)) if self.parameters else rates
        self.basis = casadi.simplify(casadi.horzcat(constant, slopes))
        self._suprema: list[Supremum] | None = None

    def bounds(self, parameters: Floats, *, method: str = "enclosed", relative: float = 1e-6) -> list[RateBounds]:
        """Bounds for every row of ``parameters`` (N, p).

        Raises
        ------
        RateError: for bounds from the corners of the box.
        EnclosureError: if a rate has no finite enclosure.
        """
        if method == "corners":
            raise RateError(
                "rates have their maxima anywhere in the box: at the corners of +-pi/2 those of example 2.4.1 are "
                "zero, which would make a false map (erratum 2.4.1-phi); use enclosed, or sampled for a first look"
            )
        if method not in ("enclosed", "sampled"):
            raise ArgumentError("method", '"enclosed" or "sampled"', repr(method))
        weights = np.hstack([np.ones((len(parameters), 1)), parameters])
        if method == "sampled":
            low = high = self._sampled(weights)
        else:
            low, high = self._enclosed(weights, relative)
        return [
            RateBounds(one_low, one_high, proven=method != "sampled")
            for one_low, one_high in zip(np.maximum(low, 0.0), np.maximum(high, 0.0), strict=True)
        ]

    def _enclosed(self, weights: Floats, relative: float) -> tuple[Floats, Floats]:
        if self._suprema is None:
            self._suprema = [Supremum(self.basis[r, :].T, self.variables) for r in range(self.count)]
        pairs = [one.enclose(self.low, self.high, weights, relative=relative) for one in self._suprema]
        return np.stack([low for low, _ in pairs], axis=1), np.stack([high for _, high in pairs], axis=1)

    def _sampled(self, weights: Floats) -> Floats:
        """Largest values on a grid that includes the faces of the box."""
        casadi = casadi_module()
        d = len(self.low)
        side = max(3, int(_SAMPLES ** (1.0 / d)) | 1)
        axes = [np.linspace(a, b, side) for a, b in zip(self.low, self.high, strict=True)]
        points = np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")])
        function = casadi.Function("basis", [self.variables], [casadi.densify(casadi.vec(self.basis))])
        values = np.array(function.map(points.shape[1])(points)).reshape(-1, self.count, points.shape[1])
        out = np.empty((len(weights), self.count))
        for r in range(self.count):
            for start in range(0, len(weights), 200):
                out[start : start + 200, r] = (weights[start : start + 200] @ values[:, r]).max(axis=1)
        return out
