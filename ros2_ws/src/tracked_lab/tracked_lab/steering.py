"""What turns reference and estimates into commands; the NMPC layers are the stack's own way to do it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from nmpc_layers import LowerLayer, LowerOutput, LowerSettings, UpperLayer, UpperOutput, UpperSettings
from tracked_description import Robot
from tracked_lab.tuning import NodeParameters, check_known, tuning_of
from tracked_types import Odometry, Slip, SolverStatus, Trajectory, VelocityCommand

Wire = Callable[[Any, Callable[[Any], None]], None]
"""Carries an item to a receiver, now or later, or loses it."""


def direct(item: Any, receiver: Callable[[Any], None]) -> None:
    """The wire that hands everything over at once."""
    receiver(item)


@dataclass(frozen=True, slots=True)
class SteeringOutput:
    """What one odometry brought about.

    command: for the arbiter, stamped with the odometry that it answers. upper, lower: of the NMPC layers, for the
    record. status: one tick of a way to steer that has no layers; it is recorded as the lower layer's.
    """

    command: VelocityCommand | None = None
    upper: UpperOutput | None = None
    lower: LowerOutput | None = None
    status: SolverStatus | None = None


class Steering(Protocol):
    """A way to steer. The pieces of reference are ahead of the robot and in the frame of the odometry."""

    def set_reference(self, reference: Trajectory) -> None:
        """The newest piece of reference."""

    def set_slip(self, slip: Slip) -> None:
        """The slip of the odometry that comes next."""

    def set_sent(self, command: VelocityCommand) -> None:
        """A command as the arbiter let it out."""

    def update(self, odometry: Odometry) -> SteeringOutput | None:
        """React to one odometry (60 Hz); None if nothing is due at its stamp."""


class NmpcLayers:
    """Upper and lower layer, or the upper layer alone, wired as their nodes are by topics.

    Parameters
    ----------
    upper: plans; alone (layers single) it also commands.
    lower: follows the plans; None for the upper layer alone.
    send_plan: link between the two.
    """

    def __init__(self, upper: UpperLayer, lower: LowerLayer | None, send_plan: Wire = direct) -> None:
        self.upper = upper
        self.lower = lower
        self._send_plan = send_plan

    @classmethod
    def from_parameters(cls, robot: Robot, parameters: NodeParameters, send_plan: Wire = direct) -> "NmpcLayers":
        """Layers with the parameters of the nodes upper_nmpc and lower_nmpc.

        Raises
        ------
        UnknownParameterError: if a parameter belongs to no settings of its node.
        ValueError: if a parameter is out of range.
        """
        upper_parameters = parameters.get("upper_nmpc", {})
        check_known("upper_nmpc", upper_parameters, (UpperSettings,))
        upper = UpperLayer(UpperSettings.from_robot(robot, **upper_parameters))
        lower_settings = lower_settings_of(robot, parameters.get("lower_nmpc", {}))
        lower = LowerLayer(lower_settings) if upper.settings.layers == "double" else None
        return cls(upper, lower, send_plan)

    def set_reference(self, reference: Trajectory) -> None:
        """The newest piece of reference."""
        self.upper.set_reference(reference)

    def set_slip(self, slip: Slip) -> None:
        """The slip of the odometry that comes next."""
        self.upper.set_slip(slip)
        if self.lower is not None:
            self.lower.set_slip(slip)

    def set_sent(self, command: VelocityCommand) -> None:
        """A command as the arbiter let it out."""
        self.upper.set_sent(command)
        if self.lower is not None:
            self.lower.set_sent(command)

    def update(self, odometry: Odometry) -> SteeringOutput | None:
        """React to one odometry: a plan that is due at its stamp is there before the lower layer solves."""
        planned = self.upper.update(odometry)
        if self.lower is None:
            return None if planned is None else SteeringOutput(planned.command, upper=planned)
        if planned is not None and planned.trajectory is not None:
            self._send_plan(planned.trajectory, self.lower.set_plan)
        followed = self.lower.update(odometry)
        if planned is None and followed is None:
            return None
        # An upper layer that has company does not command.
        return SteeringOutput(followed.command if followed else None, planned, followed)


def lower_settings_of(robot: Robot, parameters: Mapping[str, Any]) -> LowerSettings:
    """Settings of the lower layer from the parameters of its node; errors as `NmpcLayers.from_parameters`."""
    check_known("lower_nmpc", parameters, (LowerSettings,), "lock_step")
    return LowerSettings.from_robot(robot, **tuning_of(LowerSettings, parameters))
