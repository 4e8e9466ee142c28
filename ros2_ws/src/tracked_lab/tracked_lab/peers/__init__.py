"""What a user would pick instead: other ways to steer, by their names.

Each is a function of robot and parameters that gives a `tracked_lab.steering.Steering`. What stands in for the 5 Hz
layer (opti, do_mpc) has the pipeline's latency as that layer has it. Controllers of their own rate (pursuit, MPPI) get
the reference, which comes out of the same pipeline, by so much late, and then steer at 30 Hz from the newest odometry.
All are handed the pose by the same filter, and none is told the slip.
"""

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any

from tracked_description import Robot

Maker = Callable[[Robot, Mapping[str, Any]], Any]


def _of(module: str, name: str) -> Maker:
    def make(robot: Robot, parameters: Mapping[str, Any]) -> Any:
        return getattr(import_module(f"tracked_lab.peers.{module}"), name)(robot, parameters)

    return make


PEERS: Mapping[str, Maker] = {
    "pure_pursuit": _of("pursuit", "pure_pursuit"),
    "regulated_pure_pursuit": _of("pursuit", "regulated_pure_pursuit"),
    "mppi": _of("mppi", "mppi"),
    "opti": _of("usual_solvers", "opti"),
    "do_mpc": _of("usual_solvers", "do_mpc"),
    "constant_multiplier": _of("constant_multiplier", "constant_multiplier"),
}

PEER_WEIGHTS: Mapping[str, str] = {"opti": "single", "do_mpc": "single", "constant_multiplier": "double_improved"}
"""Peers that solve the layers' problems, and the way of Table 5.1 whose tuned weights they have."""
