"""The stack's algorithm objects, wired as their nodes are wired by topics."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from nmpc_layers import LowerLayer, LowerOutput, LowerSettings, UpperLayer, UpperOutput, UpperSettings
from tracked_description import Robot
from tracked_lab.tuning import check_known, tuning_of
from tracked_localization import Estimate, OdometryFilter, OdometryFilterSettings, SlipSettings
from tracked_navigation import PlayerOutput, PlayerSettings, ReferenceSettings, TrajectoryPlayer, make_reference
from tracked_navigation.shape_settings import ShapeSettings
from tracked_safety import ArbiterSettings, CommandArbiter, CommandRefused
from tracked_types import VelocityCommand

NodeParameters = Mapping[str, Mapping[str, Any]]
"""Node name -> parameter name -> value, as `tracked_report.node_parameters.node_parameters` gives them."""


@dataclass(frozen=True, slots=True)
class Reaction:
    """What the stack did with one estimate.

    asked: what a control layer wants; sent: what the arbiter let through to the base; refused: why it did not
    take what was asked, or "".
    """

    estimate: Estimate
    player: PlayerOutput
    upper: UpperOutput | None
    lower: LowerOutput | None
    asked: VelocityCommand | None
    sent: VelocityCommand | None
    refused: str = ""


class Stack:
    """Odometry filter, trajectory player, control layers and arbiter of one robot.

    One call of `react` per estimate does what the graph does in lock-step: the reference and the plan that
    are due at the estimate's stamp are there before the lower layer solves.

    Raises
    ------
    UnknownParameterError: if a parameter belongs to no settings of its node.
    ValueError: if a parameter is out of range or the reference cannot be driven.
    """

    def __init__(self, robot: Robot, parameters: NodeParameters) -> None:
        self.filter = OdometryFilter(_filter_settings(robot, parameters.get("ekf", {})))
        self.player = _player(robot, parameters.get("trajectory_player", {}))
        upper, lower = parameters.get("upper_nmpc", {}), parameters.get("lower_nmpc", {})
        check_known("upper_nmpc", upper, (UpperSettings,))
        check_known("lower_nmpc", lower, (LowerSettings,), "lock_step")
        self.upper = UpperLayer(UpperSettings.from_robot(robot, **upper))
        self.lower = None
        if self.upper.settings.layers == "double":
            self.lower = LowerLayer(LowerSettings.from_robot(robot, **tuning_of(LowerSettings, lower)))
        arbiter = parameters.get("command_arbiter", {})
        check_known("command_arbiter", arbiter, (ArbiterSettings,))
        self.arbiter = CommandArbiter(ArbiterSettings.from_robot(robot, **arbiter))

    def react(self, estimate: Estimate) -> Reaction:
        """Everything that happens because of one estimate of odometry and slip."""
        odometry = estimate.odometry
        stopped = self.arbiter.tick(odometry.stamp_ns)
        played = self.player.update(odometry)
        if played.reference is not None:
            self.upper.set_reference(played.reference)
        planned = self.upper.update(odometry)
        steered = self._steer(estimate, planned)
        asked = steered.command if steered else planned.command if planned else None
        sent, refused = stopped, ""
        if asked is not None:
            try:
                sent = self.arbiter.offer("nav", asked)
            except CommandRefused as refusal:
                refused = refusal.reason
        if sent is not None:
            self.upper.set_sent(sent)
            if self.lower is not None:
                self.lower.set_sent(sent)
        return Reaction(estimate, played, planned, steered, asked, sent, refused)

    def _steer(self, estimate: Estimate, planned: UpperOutput | None) -> LowerOutput | None:
        if self.lower is None:
            return None
        self.lower.set_slip(estimate.slip)
        if planned is not None and planned.trajectory is not None:
            self.lower.set_plan(planned.trajectory)
        return self.lower.update(estimate.odometry)


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
