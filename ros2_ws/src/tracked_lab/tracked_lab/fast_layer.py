"""One 30 Hz layer: what the lower layer does, along the reference itself instead of an upper layer's plan."""

from collections import deque
from collections.abc import Mapping
from typing import Any

from nmpc_layers import LowerLayer, LowerSettings
from tracked_description import Robot
from tracked_lab.steering import SteeringOutput, lower_settings_of
from tracked_types import Odometry, Slip, Trajectory, VelocityCommand, to_nanoseconds


class FastLayer:
    """Lag, delay and slip are made good as by the lower layer, without anybody who looks further ahead.

    A piece of reference comes out of the same pipeline as an upper layer's plan: it takes effect with the first
    odometry that is ``pipeline_latency_s`` younger. There is no final approach.
    """

    def __init__(self, settings: LowerSettings) -> None:
        self.layer = LowerLayer(settings)
        self._latency_ns = to_nanoseconds(settings.pipeline_latency_s)
        self._pieces: deque[Trajectory] = deque()

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
        self._pieces.append(reference)

    def set_slip(self, slip: Slip) -> None:
        """The slip of the odometry that comes next."""
        self.layer.set_slip(slip)

    def set_sent(self, command: VelocityCommand) -> None:
        """A command as the arbiter let it out."""
        self.layer.set_sent(command)

    def update(self, odometry: Odometry) -> SteeringOutput | None:
        """React to one odometry; None if nothing is due at its stamp."""
        while self._pieces and self._pieces[0].stamp_ns + self._latency_ns <= odometry.stamp_ns:
            self.layer.set_plan(self._pieces.popleft())
        followed = self.layer.update(odometry)
        return None if followed is None else SteeringOutput(followed.command, lower=followed)
