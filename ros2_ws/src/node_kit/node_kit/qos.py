"""The four qualities of service that the stack uses."""

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from node_kit.parameter import Parameter

SENSOR = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
"""Streams where the newest counts and a lost one does not matter."""

RELIABLE_SENSORS = Parameter(
    "reliable_sensors",
    False,
    "Subscribe sensors reliably, so that no sample is lost; then drivers that publish best effort are not heard.",
)
"""For nodes that hear sensors; see `sensor`."""

STATE = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE)
"""Estimates, plans and results that others wait for."""

LATCHED = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
"""Facts that late subscribers need: maps, static transforms, the robot description, e-stop."""

COMMAND = QoSProfile(depth=10, reliability=ReliabilityPolicy.RELIABLE)
"""Commands; a lost one would stall a lock-step run."""


def sensor(*, reliable: bool, depth: int = 10) -> QoSProfile:
    """Quality of service for a subscription of sensor samples, as the parameter RELIABLE_SENSORS says."""
    return QoSProfile(depth=depth, reliability=(STATE if reliable else SENSOR).reliability)
