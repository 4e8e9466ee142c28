"""Levenberg-Marquardt on the sparse band.

A step is taken in all nodes alike, poses and speeds; then the poses are set to what the speeds lead to. So every band
can be driven, and the curvature of its equations of motion does not hold up the descent.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dpbsv

from casadi_code import FunctionBuffer, compiled
from tracked_navigation.band.interval_cost import FAR_M, NODE, PARAMETERS, SLOT_COUNT, band_function
from tracked_navigation.band.settings import BandSettings
from tracked_types import wrap_angle

Array = NDArray[np.float64]
Association = Callable[[Array], Array]

INTERVALS = 24
_PLANNED_SHARE = 0.97  # of each limit, so that what is soft here stays within what is checked
_BANDWIDTH = 2 * NODE - 1
_FIRST_DAMPING, _LEAST_DAMPING, _MOST_DAMPING = 1e-3, 1e-7, 1e5
_CONVERGED_GAIN = 2e-3
_STEP_LIMIT = np.array([0.3, 0.3, 0.5, 0.5, 2.0, 1.0])  # of one iteration, so that no band turns inside out


@dataclass(frozen=True, slots=True)
class BandEnd:
    """Where a band ends: target (6,) of the last node and the inverse sigma (6,) of each entry, 0 if free."""

    target: Array
    weight: Array

    @classmethod
    def at_rest(cls, goal: Array) -> "BandEnd":
        """At the pose ``goal`` (3,), standing."""
        weight = np.array([1e3, 1e3, 5e2, 1e3, 5e2, 0.0])
        return cls(np.concatenate([goal, np.zeros(3)]), weight)

    @classmethod
    def passing(cls, goal: Array) -> "BandEnd":
        """About the pose ``goal`` (3,), at any speed."""
        return cls(np.concatenate([goal, np.zeros(3)]), np.array([6.0, 6.0, 3.0, 0.0, 0.0, 0.0]))


@dataclass(frozen=True, slots=True)
class Optimised:
    """nodes: (n + 1, 6). cost: sum of squared residuals. converged: the last step gained next to nothing."""

    nodes: Array
    cost: float
    iterations: int
    converged: bool


class BandOptimizer:
    """Pulls bands of up to `INTERVALS` intervals tight."""

    def __init__(self, settings: BandSettings) -> None:
        self.settings = settings
        function = band_function(INTERVALS)
        self.interpreter_reason = ""
        if settings.compile_solver:
            function, self.interpreter_reason = compiled(function)
        self._function = FunctionBuffer(function)
        inputs, outputs = self._function.inputs, self._function.outputs
        self._nodes, self._slots = inputs["nodes"], inputs["slots"]
        self._slots[:] = _EMPTY_SLOTS
        self._parameters = inputs["parameters"]
        self._cost, self._driven = outputs["cost"].reshape(-1), outputs["driven"]
        self._gradients = outputs["gradient_first"], outputs["gradient_last"]
        shape = (INTERVALS, NODE, NODE)
        # CasADi stores by columns: [interval, column, row].
        self._models = tuple(outputs[name].reshape(shape) for name in ("model_first", "model_across", "model_last"))
        self.set_speed_limit(settings.cruise_mps)

    def set_speed_limit(self, speed_mps: float) -> None:
        """Largest speed ahead from now on."""
        settings, limits = self.settings, self.settings.limits
        share, footprint = _PLANNED_SHARE, settings.footprint
        values = {
            "speed_min": share * max(limits.speed_min_mps, -settings.reverse_mps),
            "speed_max": share * min(speed_mps, limits.speed_max_mps),
            "yaw_rate_max": share * limits.yaw_rate_radps,
            "acceleration": share * limits.acceleration_mps2,
            "yaw_acceleration": share * limits.yaw_acceleration_radps2,
            "track_speed": share * limits.track_speed_mps,
            "half_gauge": limits.half_gauge_m,
            "front": footprint.front_m,
            "rear": footprint.rear_m,
            "half_width": footprint.half_width_m,
            "clearance": settings.clearance_m,
            "mover_clearance": settings.mover_clearance_m,
            "mover_growth": settings.mover_growth_mps,
        }
        self._parameters.reshape(-1)[:] = [values[name] for name in PARAMETERS]

    @property
    def parameters(self) -> Array:
        """Numbers (.,) of the band's functions, in the order of `PARAMETERS`."""
        return self._parameters.reshape(-1).copy()

    def optimise(self, nodes: Array, end: BandEnd, associate: Association, iterations: int) -> Optimised:
        """The band near ``nodes`` (n + 1, 6) that costs least; its first node stays as it is.

        associate: which obstacles each node but the first has to heed, (n, slots); asked again as the band moves.
        """
        intervals = len(nodes) - 1
        end = BandEnd(_turned_near(end.target, nodes[-1, 2]), end.weight)
        self._slots[:intervals] = associate(nodes[1:])
        cost, best = self._evaluate(nodes, end)
        model, gradient = self._normal_equations(intervals, end, best)
        damping, growth, done, converged = _FIRST_DAMPING, 4.0, 0, False
        while done < iterations and damping < _MOST_DAMPING and not converged:
            done += 1
            step = _solved(model, gradient, damping)
            trial_cost = np.inf
            if step is not None:
                trial = best.copy()
                trial[1:] += _shortened(step.reshape(intervals, NODE))
                trial_cost, trial = self._evaluate(trial, end)
            gained = (cost - trial_cost) / cost
            converged = abs(gained) < _CONVERGED_GAIN
            if step is None or gained <= 0.0:
                damping, growth = damping * growth, 2.0 * growth
                continue
            # The closer to what the model promised, the farther it is trusted.
            kept = gained * cost / -float(gradient @ step)
            damping, growth = max(damping * max(0.2, 1.0 - (2.0 * kept - 1.0) ** 3), _LEAST_DAMPING), 4.0
            best, cost = trial, trial_cost
            if done % 3 == 0:
                self._slots[:intervals] = associate(best[1:])
                cost, _ = self._evaluate(best, end)
            if not converged:
                model, gradient = self._normal_equations(intervals, end, best)
        return Optimised(best, cost, done, converged)

    def _evaluate(self, nodes: Array, end: BandEnd) -> tuple[float, Array]:
        """Cost and nodes of the band with poses that follow from its speeds; the model is that of these nodes."""
        intervals = len(nodes) - 1
        self._nodes[: intervals + 1] = nodes
        self._nodes[intervals + 1 :] = nodes[-1]
        self._function.call()
        driven = self._driven[: intervals + 1].copy()
        miss = end.weight * (driven[-1] - end.target)
        return float(self._cost[:intervals].sum() + miss @ miss), driven

    def _normal_equations(self, intervals: int, end: BandEnd, nodes: Array) -> tuple[Array, Array]:
        """Lower band storage (12, 6 n) of J'J, and J'r (6 n,), of the nodes but the first, as last evaluated."""
        first, across, last = self._models
        diagonal = last[:intervals].copy()
        diagonal[:-1] += first[1:intervals]
        diagonal[-1, _AXES, _AXES] += end.weight**2
        banded = np.zeros((intervals, NODE, _BANDWIDTH + 1))
        banded[:, _LOW_COLUMN, _LOW_ROW - _LOW_COLUMN] = diagonal[:, _LOW_COLUMN, _LOW_ROW]
        banded[:-1, _ALL_COLUMN, NODE + _ALL_ROW - _ALL_COLUMN] = across[1:intervals, _ALL_COLUMN, _ALL_ROW]
        from_first, from_last = self._gradients
        gradient = from_last[:intervals].copy()
        gradient[:-1] += from_first[1:intervals]
        gradient[-1] += end.weight**2 * (nodes[-1] - end.target)
        return banded.reshape(intervals * NODE, _BANDWIDTH + 1).T, gradient.reshape(-1)


_EMPTY_SLOTS = np.zeros(SLOT_COUNT)
_EMPTY_SLOTS[:] = [*([FAR_M] * 8), *([FAR_M, FAR_M, 0.0, 0.0, 0.0] * 2)]
_AXES = np.arange(NODE)
_LOW_ROW, _LOW_COLUMN = np.tril_indices(NODE)
_ALL_ROW, _ALL_COLUMN = (indices.ravel() for indices in np.indices((NODE, NODE)))


def _turned_near(target: Array, yaw_rad: float) -> Array:
    """``target`` with its heading within half a turn of ``yaw_rad``."""
    turned = target.copy()
    turned[2] = yaw_rad + wrap_angle(float(target[2]) - yaw_rad)
    return turned


def _solved(model: Array, gradient: Array, damping: float) -> Array | None:
    damped = model.copy(order="F")
    damped[0] += damping * damped[0] + 1e-6
    _, step, failed = dpbsv(damped, -gradient, lower=1, overwrite_ab=1)
    return None if failed or not np.isfinite(step).all() else step


def _shortened(step: Array) -> Array:
    """The step (n, 6), scaled so that no entry exceeds its limit."""
    excess = float((np.abs(step) / _STEP_LIMIT).max())
    return step if excess <= 1.0 else step / excess
