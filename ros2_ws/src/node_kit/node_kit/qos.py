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

STATE = QoSProfile(depth=200, reliability=ReliabilityPolicy.RELIABLE)
"""Estimates, plans, results and what a record must hold without a gap.

A writer drops what falls out of its depth even before every reader has it. In lock-step the world waits for commands
only, so an onlooker that gets no processor for some tenths of a second must find here what it missed.
"""

LATCHED = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
"""Facts that late subscribers need: maps, static transforms, the robot description, e-stop."""

COMMAND = STATE
"""Commands; a lost one would stall a lock-step run."""


def sensor(*, reliable: bool, depth: int | None = None) -> QoSProfile:
    """Quality of service for a subscription of sensor samples, as the parameter RELIABLE_SENSORS says.

    Who wants every sample must also keep those that come while it has no processor.
    """
    kind = STATE if reliable else SENSOR
    return QoSProfile(depth=kind.depth if depth is None else depth, reliability=kind.reliability)
