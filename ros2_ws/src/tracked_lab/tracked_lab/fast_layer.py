"""One 30 Hz layer: what the lower layer does, along the reference itself instead of an upper layer's plan."""

from collections.abc import Mapping
from typing import Any

from nmpc_layers import LowerLayer, LowerSettings
from tracked_description import Robot
from tracked_lab.reference_feed import ReferenceFeed
from tracked_lab.steering import SteeringOutput, lower_settings_of
from tracked_types import Odometry, Slip, Trajectory, VelocityCommand


class FastLayer:
    """Lag, delay and slip are made good as by the lower layer, without anybody who looks further ahead.

    A piece of reference comes out of the same pipeline as an upper layer's plan: it takes effect with the first
    odometry that is ``pipeline_latency_s`` younger. There is no final approach.
    """

    def __init__(self, settings: LowerSettings) -> None:
        self.layer = LowerLayer(settings)
        self._feed = ReferenceFeed(settings.pipeline_latency_s)

    @classmethod
    def from_parameters(cls, robot: Robot, parameters: Mapping[str, Any]) -> "FastLayer":
        """A layer with parameters of the node lower_nmpc; the seed of the run means nothing to it.

        Raises
        ------
        UnknownParameterError: if a parameter is not the lower layer's.
        ValueError: if a parameter is out of range.
        """
        own = {name: value for name, value in parameters.items() if name != "seed"}
        return cls(lower_settings_of(robot, own))

    def set_reference(self, reference: Trajectory) -> None:
        """The newest piece of reference."""
        self._feed.add(reference)

    def set_slip(self, slip: Slip) -> None:
        """The slip of the odometry that comes next."""
        self.layer.set_slip(slip)

    def set_sent(self, command: VelocityCommand) -> None:
        """A command as the arbiter let it out."""
        self.layer.set_sent(command)

    def update(self, odometry: Odometry) -> SteeringOutput | None:
        """React to one odometry; None if nothing is due at its stamp."""
        piece = self._feed.release(odometry.stamp_ns)
        if piece is not None:
            self.layer.set_plan(piece)
        followed = self.layer.update(odometry)
        return None if followed is None else SteeringOutput(followed.command, lower=followed)
