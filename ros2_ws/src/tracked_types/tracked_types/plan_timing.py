"""When plans are made and when they take effect; both layers, the reference and the scenarios count with it."""

PLAN_RATE_HZ = 5
"""Plans per second of the upper layer, unless it is told otherwise: the grid of its instants."""

PIPELINE_LATENCY_S = 0.1
"""Time from the odometry that a plan is made from to its effect, unless told otherwise (s)."""
