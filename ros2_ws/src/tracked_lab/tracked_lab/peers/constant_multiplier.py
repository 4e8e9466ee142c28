"""The industry's answer to tracks that slip: multiply every yaw rate by one constant.

It gets the layers as they are but for the slip, with the weights tuned for the improved layers: on the tuning seeds it
does better with them than with the nodes' own or with those tuned for layers without slip (search_log.jsonl).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from tracked_description import Robot
from tracked_lab.peers import PEER_WEIGHTS
from tracked_lab.peers.control_peer import SHARED
from tracked_lab.steering import NmpcLayers, SteeringOutput
from tracked_lab.table_variants import packaged_weights
from tracked_lab.tuning import check_known, tuning_of
from tracked_types import Odometry, Slip, Trajectory, Twist2, VelocityCommand
from tracked_types.setting import check_settings, setting


@dataclass(frozen=True, slots=True, kw_only=True)
class MultiplierSettings:
    """The constant, and the weights of the layers that it serves."""

    factor: float = setting(1.25, "yaw rate asked of the belts per yaw rate wanted", low=0.5, high=3.0)
    weights_file: str = setting("", "YAML file of weights; empty: those of double_improved")

    def __post_init__(self) -> None:
        check_settings(self)


class ConstantMultiplier:
    """Both layers with everything but the slip, and the constant in its place."""

    def __init__(self, layers: NmpcLayers, factor: float) -> None:
        self._layers, self._factor = layers, factor

    def set_reference(self, reference: Trajectory) -> None:
        """The newest piece of reference."""
        self._layers.set_reference(reference)

    def set_slip(self, slip: Slip) -> None:
        """The constant stands for it."""

    def set_sent(self, command: VelocityCommand) -> None:
        """The layers think in yaw rates over ground."""
        self._layers.set_sent(self._multiplied(command, 1.0 / self._factor))

    def update(self, odometry: Odometry) -> SteeringOutput | None:
        """What the layers say, multiplied."""
        output = self._layers.update(odometry)
        if output is None or output.command is None:
            return output
        return SteeringOutput(self._multiplied(output.command, self._factor), output.upper, output.lower)

    @staticmethod
    def _multiplied(command: VelocityCommand, factor: float) -> VelocityCommand:
        twist = command.twist
        return VelocityCommand(command.stamp_ns, Twist2(twist.speed_mps, factor * twist.yaw_rate_radps))


def constant_multiplier(robot: Robot, parameters: Mapping[str, Any]) -> ConstantMultiplier:
    """Layers without slip behind a constant."""
    check_known("constant_multiplier", parameters, (MultiplierSettings,), *SHARED)
    settings = MultiplierSettings(**tuning_of(MultiplierSettings, parameters))
    weights = settings.weights_file or str(packaged_weights(PEER_WEIGHTS["constant_multiplier"]))
    shared = {"weights_file": weights, "pipeline_latency_s": parameters["pipeline_latency_s"]}
    layers = NmpcLayers.from_parameters(
        robot,
        {
            "upper_nmpc": {**shared, "rate_hz": parameters["plan_rate_hz"]},
            "lower_nmpc": {**shared, "plan_rate_hz": parameters["plan_rate_hz"], "slip_compensation": False},
        },
    )
    return ConstantMultiplier(layers, settings.factor)
