"""The band's problem with its constraints kept exactly, by IPOPT: the peer of the benchmark."""

from typing import Any

import casadi
import numpy as np
from numpy.typing import NDArray

from tracked_navigation.band import interval_cost as cost
from tracked_navigation.band.optimizer import BandEnd, BandOptimizer
from tracked_navigation.band.settings import BandSettings
from tracked_types import wrap_angle

Array = NDArray[np.float64]


class IpoptBand:
    """Poses, speeds and times of all nodes as unknowns; motion, limits and accelerations as constraints; the same price
    of time, smoothness, reverse, clearance and of missing the end as the band has."""

    def __init__(self, settings: BandSettings, intervals: int) -> None:
        self.intervals = intervals
        self._numbers = BandOptimizer(settings).parameters
        symbol = casadi.SX.sym
        nodes, slots = symbol("nodes", cost.NODE, intervals + 1), symbol("slots", cost.SLOT_COUNT, intervals)
        parameters, target = symbol("parameters", len(cost.PARAMETERS)), symbol("target", cost.NODE)
        weight, start = symbol("weight", cost.NODE), symbol("start", cost.NODE)
        price, motion, bounded = casadi.SX(0), [nodes[:, 0] - start], []
        for index in range(intervals):
            first, last = nodes[:, index], nodes[:, index + 1]
            soft = cost.wishes_of(first, last, slots[:, index], parameters)
            price += casadi.sumsqr(casadi.vertcat(*soft))
            motion += cost.defects_of(first, last)
            bounded += cost.limits_of(first, last, parameters)
        price += casadi.sumsqr(weight * (nodes[:, -1] - target))
        self._equalities = casadi.vertcat(*motion).numel()
        constraints = casadi.vertcat(*motion, *bounded)
        self._high = np.zeros(constraints.numel())
        self._low = np.concatenate([np.zeros(self._equalities), np.full(len(bounded), -np.inf)])
        problem = {
            "x": casadi.vec(nodes),
            "p": casadi.vertcat(casadi.vec(slots), parameters, target, weight, start),
            "f": price,
            "g": constraints,
        }
        options: dict[str, Any] = {"print_time": 0, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.tol": 1e-4}
        options |= {"ipopt.max_iter": 100, "ipopt.warm_start_init_point": "yes", "ipopt.mu_init": 1e-2}
        self._solver = casadi.nlpsol("band", "ipopt", problem, options)

    def solve(self, nodes: Array, end: BandEnd, slots: Array) -> tuple[Array, bool]:
        """Nodes (n + 1, 6) of the optimum near ``nodes``, and whether IPOPT says so; slots (n, .)."""
        target = end.target.copy()
        target[2] = nodes[-1, 2] + wrap_angle(float(target[2] - nodes[-1, 2]))
        given = np.concatenate([slots.ravel(), self._numbers, target, end.weight, nodes[0]])
        found = self._solver(x0=nodes.ravel(), p=given, lbg=self._low, ubg=self._high)
        return found["x"].full().reshape(-1, cost.NODE), bool(self._solver.stats()["success"])
