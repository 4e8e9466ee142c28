"""The stack's algorithm objects, wired as their nodes are wired by topics."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from tracked_description import Robot
from tracked_lab.steering import NmpcLayers, Steering, SteeringOutput, Wire, direct
from tracked_lab.tuning import NodeParameters, check_known, tuning_of
from tracked_localization import Estimate, OdometryFilter, OdometryFilterSettings, SlipSettings
from tracked_navigation import PlayerOutput, PlayerSettings, ReferenceSettings, TrajectoryPlayer, make_reference
from tracked_navigation.shape_settings import ShapeSettings
from tracked_safety import ArbiterSettings, CommandArbiter, CommandRefused, GuardSettings
from tracked_types import Slip, VelocityCommand


@dataclass(frozen=True, slots=True)
class Reaction:
    """What the stack did with one estimate.

    steered: by the steering, None if nothing was due; sent: what the arbiter let through to the base; refused: why
    it did not take what was asked, or "".
    """

    estimate: Estimate
    player: PlayerOutput
    steered: SteeringOutput | None
    sent: VelocityCommand | None
    refused: str = ""


class Stack:
    """Odometry filter, trajectory player, steering and arbiter of one robot.

    One call of `react` per estimate does what the graph does in lock-step: the reference and the plan that
    are due at the estimate's stamp are there before the steering acts.

    Parameters
    ----------
    robot, parameters: of the nodes; those of nodes that are not here are ignored.
    steering: what commands; by default the NMPC layers of the parameters.
    send_reference: link from the player to the steering.

    Raises
    ------
    UnknownParameterError: if a parameter belongs to no settings of its node.
    ValueError: if a parameter is out of range or the reference cannot be driven.
    """

    def __init__(
        self,
        robot: Robot,
        parameters: NodeParameters,
        steering: Steering | None = None,
        send_reference: Wire = direct,
    ) -> None:
        self.filter = OdometryFilter(_filter_settings(robot, parameters.get("ekf", {})))
        self.player = _player(robot, parameters.get("trajectory_player", {}))
        self.steering = steering or NmpcLayers.from_parameters(robot, parameters)
        self._send_reference = send_reference
        arbiter = parameters.get("command_arbiter", {})
        # Nothing here has a lidar, and the floors have no walls: no guard, whatever it would be set to.
        check_known("command_arbiter", arbiter, (ArbiterSettings, GuardSettings), "collision_guard")
        self.arbiter = CommandArbiter(ArbiterSettings.from_robot(robot, **tuning_of(ArbiterSettings, arbiter)))

    def react(self, estimate: Estimate, slip: Slip | None = None) -> Reaction:
        """Everything that happens because of one estimate; ``slip`` replaces that of the estimate."""
        odometry = estimate.odometry
        stopped = self.arbiter.tick(odometry.stamp_ns)
        played = self.player.update(odometry)
        if played.reference is not None:
            self._send_reference(played.reference, self.steering.set_reference)
        self.steering.set_slip(estimate.slip if slip is None else slip)
        steered = self.steering.update(odometry)
        sent, refused = stopped, ""
        if steered is not None and steered.command is not None:
            try:
                sent = self.arbiter.offer("nav", steered.command)
            except CommandRefused as refusal:
                refused = refusal.reason
        if sent is not None:
            self.steering.set_sent(sent)
        return Reaction(estimate, played, steered, sent, refused)


def _filter_settings(robot: Robot, parameters: Mapping[str, Any]) -> OdometryFilterSettings:
    check_known("ekf", parameters, (OdometryFilterSettings, SlipSettings))
    slip = SlipSettings.from_robot(robot, **tuning_of(SlipSettings, parameters))
    return OdometryFilterSettings.from_robot(robot, slip, **tuning_of(OdometryFilterSettings, parameters))


def _player(robot: Robot, parameters: Mapping[str, Any]) -> TrajectoryPlayer:
    check_known("trajectory_player", parameters, (ReferenceSettings, ShapeSettings, PlayerSettings))
    reference = make_reference(
        robot,
        ReferenceSettings(**tuning_of(ReferenceSettings, parameters)),
        ShapeSettings(**tuning_of(ShapeSettings, parameters)),
    )
    return TrajectoryPlayer(PlayerSettings(**tuning_of(PlayerSettings, parameters)), reference)
