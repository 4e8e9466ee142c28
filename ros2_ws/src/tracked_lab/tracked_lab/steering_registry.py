"""Ways to steer by their names; what a name needs is imported when it is asked for."""

from collections.abc import Mapping
from importlib import import_module
from typing import Any

from tracked_description import Robot
from tracked_lab.conditions import NMPC
from tracked_lab.fast_layer import FastLayer
from tracked_lab.steering import NmpcLayers, Steering, Wire, direct
from tracked_lab.tuning import NodeParameters

SHARED = ("pipeline_latency_s", "plan_rate_hz", "seed")
"""Parameters that every way to steer is offered, from the scenario; its own come on top."""


class UnknownSteeringError(ValueError):
    """Nobody steers by this name; the text lists the names there are."""


def make_steering(name: str, robot: Robot, parameters: Mapping[str, Any]) -> Steering:
    """The way to steer called ``name``.

    ``parameters`` are its own and, where the run has them, those called `SHARED`. Peers are those of
    ``tracked_lab.peers.PEERS``: name -> function of robot and parameters.

    Raises
    ------
    UnknownSteeringError: if there is no such name.
    UnknownParameterError, ValueError: if a parameter is unknown or out of range.
    """
    makers = _makers()
    if name not in makers:
        raise UnknownSteeringError(f"steering must be one of {', '.join((NMPC, *makers))}; got {name!r}")
    steering: Steering = makers[name](robot, parameters)
    return steering


def steering_of_run(
    name: str, robot: Robot, nodes: NodeParameters, own: Mapping[str, Any], seed: int, send_plan: Wire = direct
) -> Steering:
    """The steering of one run: the NMPC layers take the parameters of their nodes, others `SHARED` and their own.

    Raises
    ------
    ValueError: as `make_steering`, and if the NMPC layers are given parameters of their own.
    """
    if name == NMPC:
        if own:
            raise ValueError(f"steering_parameters: the layers take those of their nodes; got {', '.join(own)}")
        return NmpcLayers.from_parameters(robot, nodes, send_plan)
    planner = nodes.get("upper_nmpc", {})
    shared = {"pipeline_latency_s": planner["pipeline_latency_s"], "plan_rate_hz": planner["rate_hz"], "seed": seed}
    return make_steering(name, robot, {**shared, **own})


def _makers() -> Mapping[str, Any]:
    try:
        peers: Mapping[str, Any] = import_module("tracked_lab.peers").PEERS
    except ModuleNotFoundError as error:
        if error.name != "tracked_lab.peers":
            raise
        peers = {}
    return {"fast_layer": FastLayer.from_parameters, **peers}
