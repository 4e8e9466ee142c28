"""Coarsest step that the explicit coupling of stiff belts to the rigid chassis allows."""

import math

from robust_core.plants.x_structure import STANDARD_GRAVITY_MPS2
from tracked_description import Robot
from tracked_description.suspension import SuspensionKind

# Share of the stability limit that may be used: dt^2 k/m + 2 dt c/m < 4 for one degree of freedom.
_MARGIN = 0.7


def least_rate_hz(robot: Robot, kind: SuspensionKind) -> float:
    """Physics rate below which the robot would shake itself off the ground (Hz).

    A sprung chassis meets the stiff belts through wheels whose equations are solved implicitly; with the suspension
    locked it meets them directly, and roll, stiffened by contact and by lateral shear, is its fastest motion.
    """
    if kind != "locked":
        return 0.0
    chassis, tracks, ground = robot.chassis, robot.tracks, robot.ground
    wheels = 2 * tracks.wheel_count
    weight = (chassis.sprung_mass_kg + wheels * chassis.unit_mass_kg) * STANDARD_GRAVITY_MPS2
    arm, height = 0.5 * tracks.gauge_m, chassis.com_height_m
    lateral_stiffness = ground.friction_lateral * weight / ground.shear_displacement_m
    lateral_damping = weight * math.sqrt(
        ground.friction_longitudinal / (STANDARD_GRAVITY_MPS2 * ground.shear_displacement_m)
    )
    inertia = chassis.inertia_kgm2[0]
    stiffness = (wheels * ground.contact_stiffness_npm * arm**2 + lateral_stiffness * height**2) / inertia
    damping = (wheels * ground.contact_damping_nspm * arm**2 + lateral_damping * height**2) / inertia
    step = (math.sqrt(damping**2 + 4.0 * _MARGIN * stiffness) - damping) / stiffness
    return 1.0 / step
