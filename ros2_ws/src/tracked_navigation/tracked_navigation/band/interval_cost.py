"""Cost of one interval of the band and its Gauss-Newton model, as CasADi functions.

A node is (x, y, yaw, v, w, t): pose, speed, yaw rate and time. Between nodes speed and yaw rate are linear in time, so
that displacement and rotation follow from their means and the mean heading (erratum 5.2.4). With the time as a part of
the node the movers' predictions have exact derivatives, and the Hessian stays block tridiagonal.
"""

from typing import Any

import casadi

Expression = Any  # casadi ships no types

NODE = 6
POINT_SLOTS = 4  # the nearest obstacle point in each quadrant around the robot
MOVER_SLOTS = 2
MOVER_FIELDS = 5  # x, y, their rates, radius
SLOT_COUNT = 2 * POINT_SLOTS + MOVER_FIELDS * MOVER_SLOTS
FAR_M = 1e3  # where the point of an empty slot lies

PARAMETERS = (
    *("speed_min", "speed_max", "yaw_rate_max", "acceleration", "yaw_acceleration", "track_speed", "half_gauge"),
    *("front", "rear", "half_width", "clearance", "mover_clearance", "mover_growth"),
)

# One sigma of each residual: what deviates by so much costs 1. The first ones are constraints in all but name.
DEFECT_M, DEFECT_RAD = 1e-3, 2e-3
SPEED_MPS, YAW_RATE_RADPS, TRACK_MPS = 0.01, 0.03, 0.01
SPEED_STEP_MPS, YAW_RATE_STEP_RADPS = 0.005, 0.02
CLEARANCE_M, MOVER_CLEARANCE_M = 0.03, 0.05
SHORTEST_S, LONGEST_S = 0.05, 0.9
SHORT_S, LONG_S = 0.005, 0.1
# The last ones say what is liked: little time, smooth driving, and ahead.
TIME_S, SMOOTH_MPS, SMOOTH_RADPS, REVERSE_MPS = 0.8, 1.0, 1.2, 0.2


def interval_function() -> Any:
    """Function of (node, next node, slots, parameters) to (cost, gradients (6,) of both, blocks (6, 6) of J'J)."""
    first, last = casadi.SX.sym("first", NODE), casadi.SX.sym("last", NODE)
    slots = casadi.SX.sym("slots", SLOT_COUNT)
    parameters = casadi.SX.sym("parameters", len(PARAMETERS))
    residuals = casadi.vertcat(*residuals_of(first, last, slots, parameters))
    both = casadi.vertcat(first, last)
    jacobian = casadi.jacobian(residuals, both)
    model = casadi.densify(casadi.mtimes(jacobian.T, jacobian))
    gradient = casadi.densify(casadi.mtimes(jacobian.T, residuals))
    outputs: list[Expression] = [casadi.dot(residuals, residuals), gradient[:NODE], gradient[NODE:]]
    outputs += [model[:NODE, :NODE], model[NODE:, :NODE], model[NODE:, NODE:]]
    return casadi.Function("band_interval", [first, last, slots, parameters], outputs)


def band_function(intervals: int) -> Any:
    """Drives along the speeds of nodes (6, n + 1), then `interval_function` over all intervals of what was driven.

    Of nodes, slots (., n) and parameters; to the driven nodes, and costs, gradients and blocks side by side.
    """
    nodes = casadi.MX.sym("nodes", NODE, intervals + 1)
    slots = casadi.MX.sym("slots", SLOT_COUNT, intervals)
    parameters = casadi.MX.sym("parameters", len(PARAMETERS))
    drive = _drive_function().mapaccum("band_drive", intervals)
    poses = drive(nodes[:3, 0], nodes[3:, :-1], nodes[3:, 1:])
    driven = casadi.vertcat(casadi.horzcat(nodes[:3, 0], poses), nodes[3:, :])
    mapped = interval_function().map("band_intervals", "serial", intervals, [3], [])
    outputs = mapped(driven[:, :-1], driven[:, 1:], slots, parameters)
    names = ["driven", "cost", "gradient_first", "gradient_last", "model_first", "model_across", "model_last"]
    return casadi.Function(
        "elastic_band", [nodes, slots, parameters], [driven, *outputs], ["nodes", "slots", "parameters"], names
    )


def _drive_function() -> Any:
    """Pose (3,) and speed, yaw rate and time (3,) of a node and of the next to the next pose."""
    pose, first, last = casadi.SX.sym("pose", 3), casadi.SX.sym("first", 3), casadi.SX.sym("last", 3)
    way, turn = way_and_turn(first, last)
    heading = pose[2] + 0.5 * turn
    reached = pose + casadi.vertcat(way * casadi.cos(heading), way * casadi.sin(heading), turn)
    return casadi.Function("band_drive_step", [pose, first, last], [reached])


def residuals_of(first: Expression, last: Expression, slots: Expression, parameters: Expression) -> list[Expression]:
    """Everything an interval and the node at its end are judged by, in sigmas."""
    limits = [_beyond(excess) for excess in limits_of(first, last, parameters)]
    return [*defects_of(first, last), *limits, *wishes_of(first, last, slots, parameters)]


def limits_of(first: Expression, last: Expression, parameters: Expression) -> list[Expression]:
    """By how much each limit is exceeded, in sigmas; negative within it."""
    p: dict[str, Expression] = dict(zip(PARAMETERS, casadi.vertsplit(parameters), strict=True))
    step, speed, yaw_rate = last[5] - first[5], last[3], last[4]
    faster, turning = p["acceleration"] * step, p["yaw_acceleration"] * step
    return [
        *_outside(speed, p["speed_min"], p["speed_max"], SPEED_MPS),
        *_outside(yaw_rate, -p["yaw_rate_max"], p["yaw_rate_max"], YAW_RATE_RADPS),
        *_outside(speed + p["half_gauge"] * yaw_rate, -p["track_speed"], p["track_speed"], TRACK_MPS),
        *_outside(speed - p["half_gauge"] * yaw_rate, -p["track_speed"], p["track_speed"], TRACK_MPS),
        *_outside(speed - first[3], -faster, faster, SPEED_STEP_MPS),
        *_outside(yaw_rate - first[4], -turning, turning, YAW_RATE_STEP_RADPS),
        (SHORTEST_S - step) / SHORT_S,
        (step - LONGEST_S) / LONG_S,
    ]


def wishes_of(first: Expression, last: Expression, slots: Expression, parameters: Expression) -> list[Expression]:
    """What may be traded against one another: time, smoothness, driving ahead, and room beyond what the check asks."""
    p: dict[str, Expression] = dict(zip(PARAMETERS, casadi.vertsplit(parameters), strict=True))
    liked = [
        (last[5] - first[5]) / TIME_S,
        (last[3] - first[3]) / SMOOTH_MPS,
        (last[4] - first[4]) / SMOOTH_RADPS,
        _beyond(-last[3]) / REVERSE_MPS,
    ]
    points = [
        _beyond(p["clearance"] - gap_to(last, slots[2 * index], slots[2 * index + 1], p)) / CLEARANCE_M
        for index in range(POINT_SLOTS)
    ]
    movers = []
    for index in range(MOVER_SLOTS):
        x, y, x_rate, y_rate, radius = casadi.vertsplit(
            slots[2 * POINT_SLOTS + MOVER_FIELDS * index : 2 * POINT_SLOTS + MOVER_FIELDS * (index + 1)]
        )
        gap = gap_to(last, x + x_rate * last[5], y + y_rate * last[5], p) - radius
        wanted = p["mover_clearance"] + p["mover_growth"] * last[5]
        movers.append(_beyond(wanted - gap) / MOVER_CLEARANCE_M)
    return liked + points + movers


def way_and_turn(first: Expression, last: Expression) -> tuple[Expression, Expression]:
    """Chord (m) and rotation (rad) between two nodes, of which (speed, yaw rate, time) are given."""
    step = last[2] - first[2]
    turn = 0.5 * step * (first[1] + last[1])
    # The chord of an arc is shorter than the arc, to the second order by this much.
    return 0.5 * step * (first[0] + last[0]) * (1.0 - turn**2 / 24.0), turn


def defects_of(first: Expression, last: Expression) -> list[Expression]:
    """By how much the next pose differs from where the speeds lead, x, y and yaw, in sigmas."""
    way, turn = way_and_turn(first[3:], last[3:])
    heading = 0.5 * (first[2] + last[2])
    return [
        (last[0] - first[0] - way * casadi.cos(heading)) / DEFECT_M,
        (last[1] - first[1] - way * casadi.sin(heading)) / DEFECT_M,
        (last[2] - first[2] - turn) / DEFECT_RAD,
    ]


def gap_to(node: Expression, x: Expression, y: Expression, p: dict[str, Expression]) -> Expression:
    """Distance (m) of a point from the footprint of the robot at a node; negative inside, by how deep."""
    cosine, sine = casadi.cos(node[2]), casadi.sin(node[2])
    ahead = cosine * (x - node[0]) + sine * (y - node[1]) - 0.5 * (p["front"] - p["rear"])
    aside = cosine * (y - node[1]) - sine * (x - node[0])
    along = casadi.fabs(ahead) - 0.5 * (p["front"] + p["rear"])
    across = casadi.fabs(aside) - p["half_width"]
    # The small number keeps the derivative of the root finite on the edge.
    outside = casadi.sqrt(_beyond(along) ** 2 + _beyond(across) ** 2 + 1e-8)
    return outside + casadi.fmin(casadi.fmax(along, across), 0.0)


def _outside(value: Expression, low: Expression, high: Expression, sigma: float) -> tuple[Expression, Expression]:
    return (value - high) / sigma, (low - value) / sigma


def _beyond(value: Expression) -> Expression:
    return casadi.fmax(value, 0.0)
