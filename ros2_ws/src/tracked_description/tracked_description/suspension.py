"""The suspension units of a robot at rest."""

import math
from typing import Literal

from robust_core.plants.x_structure import STANDARD_GRAVITY_MPS2, XStructure
from tracked_description.robot import Robot

SuspensionKind = Literal["qzs", "linear", "locked"]


def x_structure_of(robot: Robot) -> XStructure:
    """The suspension unit of one road wheel as the plant model of robust_core knows it."""
    suspension = robot.suspension
    return XStructure(
        layers=suspension.layers,
        rod_length_m=suspension.rod_length_m,
        angle_rad=math.radians(suspension.angle_deg),
        spring_npm=suspension.spring_npm,
        joint_damping_nms=suspension.joint_damping_nms,
        joints=suspension.joint_count,
    )


def unit_load_n(robot: Robot) -> float:
    """Static load of one suspension unit on flat ground (N): the sprung weight shared evenly."""
    return robot.chassis.sprung_mass_kg * STANDARD_GRAVITY_MPS2 / (2 * robot.tracks.wheel_count)


def rest_travel_m(robot: Robot, kind: SuspensionKind) -> float:
    """Travel of one unit under its static load (m, negative in compression).

    Raises
    ------
    SnapThroughError: if the X structure cannot carry the load.
    ValueError: if the travel lies beyond a bump stop.
    """
    load, suspension = unit_load_n(robot), robot.suspension
    travel = -load / suspension.linear_spring_npm if kind == "linear" else x_structure_of(robot).equilibrium_m(load)
    if travel <= -suspension.compression_stop_m:
        raise ValueError(
            f"suspension: {load:.2f} N per unit compress it by {-travel * 1e3:.1f} mm, "
            f"beyond its stop at {suspension.compression_stop_m * 1e3:.1f} mm"
        )
    return travel


def suspension_joint_names(robot: Robot) -> tuple[str, ...]:
    """Joints of the suspension units, left side first, each side from rear to front."""
    return tuple(
        f"{side}_suspension_{number}" for side in ("left", "right") for number in range(1, robot.tracks.wheel_count + 1)
    )
