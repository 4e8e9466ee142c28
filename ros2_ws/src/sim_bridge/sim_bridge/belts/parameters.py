"""Numbers of the belt-force model, flattened for the compiled code."""

import math
from typing import NamedTuple

from robust_core.plants.x_structure import STANDARD_GRAVITY_MPS2
from tracked_description import Robot
from tracked_description.suspension import SuspensionKind, rest_travel_m, x_structure_of

QZS, LINEAR, LOCKED = 0, 1, 2
LAWS: dict[SuspensionKind, int] = {"qzs": QZS, "linear": LINEAR, "locked": LOCKED}


class BeltParameters(NamedTuple):
    """One vehicle's constants, SI units; lengths in z are heights in the frame of the centre of mass.

    ``law`` is one of QZS, LINEAR, LOCKED; ``rest_travel`` is the suspension travel that carries the robot on
    flat ground, where the wheels are ``com_height`` below the centre of mass.
    """

    sprung_mass: float
    unit_mass: float
    half_gauge: float
    wheel_radius: float
    wheel_spacing: float
    com_height: float
    idler_x: float
    idler_z: float
    mount_z: float
    belt_half_width: float
    contact_stiffness: float
    contact_damping: float
    friction_longitudinal: float
    friction_lateral: float
    shear_displacement: float
    shear_damping: float
    rolling_resistance: float
    law: int
    rest_travel: float
    spring: float
    rod_length: float
    rest_height: float
    rest_width: float
    layers: float
    preload: float
    joint_damping: float
    linear_spring: float
    linear_damping: float
    compression_stop: float
    extension_stop: float
    stop_stiffness: float
    stop_damping: float
    belt_mass: float
    driven_mass: float
    drive_response: float
    drive_speed: float
    drive_acceleration: float
    drive_proportional: float
    drive_integral: float
    drive_derivative: float
    motor_lag: float
    motor_force: float


def belt_parameters(robot: Robot, kind: SuspensionKind) -> BeltParameters:
    """Constants of the model for one robot and one suspension law; raises as `rest_travel_m`."""
    tracks, chassis, suspension, ground, drive = (
        robot.tracks,
        robot.chassis,
        robot.suspension,
        robot.ground,
        robot.drive,
    )
    structure, rest = x_structure_of(robot), rest_travel_m(robot, kind)
    return BeltParameters(
        sprung_mass=chassis.sprung_mass_kg,
        unit_mass=chassis.unit_mass_kg,
        half_gauge=0.5 * tracks.gauge_m,
        wheel_radius=tracks.wheel_radius_m,
        wheel_spacing=tracks.wheel_spacing_m,
        com_height=chassis.com_height_m,
        idler_x=tracks.idler_x_m,
        idler_z=tracks.idler_height_m - chassis.com_height_m,
        mount_z=tracks.wheel_radius_m - chassis.com_height_m + rest,
        belt_half_width=0.5 * tracks.belt_width_m,
        contact_stiffness=ground.contact_stiffness_npm,
        contact_damping=ground.contact_damping_nspm,
        friction_longitudinal=ground.friction_longitudinal,
        friction_lateral=ground.friction_lateral,
        shear_displacement=ground.shear_displacement_m,
        # Half of critical damping of a mass on its own sheared belt, per newton of normal load.
        shear_damping=math.sqrt(ground.friction_longitudinal / (STANDARD_GRAVITY_MPS2 * ground.shear_displacement_m)),
        rolling_resistance=ground.rolling_resistance,
        law=LAWS[kind],
        rest_travel=rest,
        spring=suspension.spring_npm,
        rod_length=suspension.rod_length_m,
        rest_height=structure.rest_height_m,
        rest_width=structure.rest_width_m,
        layers=float(suspension.layers),
        preload=structure.preload_m,
        joint_damping=structure.joint_damping_nms * structure.joint_count,
        linear_spring=suspension.linear_spring_npm,
        linear_damping=suspension.linear_damping_nspm,
        compression_stop=-suspension.compression_stop_m,
        extension_stop=suspension.extension_stop_m,
        stop_stiffness=suspension.stop_stiffness_npm,
        stop_damping=suspension.stop_damping_nspm,
        belt_mass=drive.belt_mass_kg,
        driven_mass=drive.belt_mass_kg + 0.5 * chassis.sprung_mass_kg + tracks.wheel_count * chassis.unit_mass_kg,
        drive_response=tracks.motor_time_constant_s,
        drive_speed=tracks.speed_limit_mps,
        drive_acceleration=tracks.acceleration_limit_mps2,
        drive_proportional=drive.proportional_nspm,
        drive_integral=drive.integral_npm,
        drive_derivative=drive.derivative_ns2pm,
        motor_lag=drive.force_lag_s,
        motor_force=tracks.force_limit_n,
    )
