"""The 5 Hz layer as most people would write it: the same problem, handed to IPOPT by CasADi's Opti or by do-mpc.

Latency, weights (those tuned for the single layer, unless a file is named) and everything around the problem are the
single layer's own, so that what differs is the solver alone.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from nmpc_layers import UpperLayer, UpperSettings
from nmpc_layers.solver import Motion, Problem, Solution
from nmpc_layers.solver.motion_model import next_state
from nmpc_layers.solver.solution import Outcome
from nmpc_layers.solver.warm_start import WarmStart
from tracked_description import Robot
from tracked_lab.ocp_peers import DoMpcPeer, OptiPeer
from tracked_lab.peers import PEER_WEIGHTS
from tracked_lab.peers.control_peer import SHARED
from tracked_lab.steering import NmpcLayers
from tracked_lab.table_variants import packaged_weights
from tracked_lab.tuning import check_known, tuning_of


class UsualSolver(WarmStart):
    """Stands where the layer has its own solver."""

    def __init__(self, kind: str, horizon: int) -> None:
        super().__init__(Motion.KINEMATIC, horizon)
        self._kind, self._horizon = kind, horizon
        self._peer: Any = OptiPeer(Motion.KINEMATIC, horizon) if kind == "opti" else None

    def solve(self, problem: Problem) -> Solution:
        """The peer's commands, and the states that they lead to."""
        if self._peer is None:  # do-mpc builds the numbers of a first problem in
            self._peer = DoMpcPeer(Motion.KINEMATIC, self._horizon, problem)
        self._peer.start_from(np.array(self._guess))
        try:
            cost = self._peer.solve(problem)
        except RuntimeError:  # IPOPT gave up
            return Solution(np.array(self._guess), np.zeros((self._horizon + 1, 3)), np.inf, 0, Outcome.STALLED)
        commands = np.clip(self._peer.commands, problem.low, problem.high)
        self._guess[:] = commands
        states, parameters = [problem.start], problem.parameters.as_array()
        for command in commands:
            after = next_state(Motion.KINEMATIC, states[-1], command, parameters)
            states.append(np.array(after, dtype=np.float64).ravel())
        return Solution(commands, np.array(states), float(cost), 1, Outcome.CONVERGED)


def opti(robot: Robot, parameters: Mapping[str, Any]) -> NmpcLayers:
    """The layer with Opti."""
    return _layer("opti", robot, parameters)


def do_mpc(robot: Robot, parameters: Mapping[str, Any]) -> NmpcLayers:
    """The layer with do-mpc."""
    return _layer("do_mpc", robot, parameters)


def _layer(kind: str, robot: Robot, parameters: Mapping[str, Any]) -> NmpcLayers:
    check_known(kind, parameters, (UpperSettings,), *SHARED)
    own = tuning_of(UpperSettings, parameters)
    own["weights_file"] = own.get("weights_file") or str(packaged_weights(PEER_WEIGHTS[kind]))
    own |= {"layers": "single", "rate_hz": parameters["plan_rate_hz"]}
    settings = UpperSettings.from_robot(robot, **own)
    layer = UpperLayer(replace(settings))
    layer.solver = UsualSolver(kind, settings.horizon)  # type: ignore[assignment]
    return NmpcLayers(layer, None)
