"""URDF of a robot, made from its numbers."""

import math
from collections.abc import Iterable
from xml.etree import ElementTree

from tracked_description.fixed_frames import FixedFrame, fixed_frames
from tracked_description.robot import Robot
from tracked_description.suspension import rest_travel_m, suspension_joint_names
from tracked_description.urdf_shapes import (
    Inertia,
    add_box,
    add_cylinder,
    add_inertial,
    add_joint,
    box_inertia,
    cylinder_inertia,
    sub_element,
)
from tracked_types import LEFT_TRACK, RIGHT_TRACK

TRACK_JOINTS = (LEFT_TRACK, RIGHT_TRACK)
SENSOR_SIZES_M = {"imu": (0.03, 0.03, 0.01), "lidar": (0.07, 0.07, 0.04), "camera": (0.025, 0.09, 0.025)}
_COLOURS = {"body": "0.25 0.27 0.30 1", "rubber": "0.08 0.08 0.08 1", "metal": "0.60 0.62 0.65 1"}
_PART_MASS_KG = 0.05  # of each sensor and sprocket; robot.yaml counts them with the chassis


def robot_urdf(robot: Robot, frame_prefix: str = "") -> str:
    """URDF text: base_footprint, chassis, sensors, and per side a drive sprocket and road wheels on their suspension.

    The track joints turn the drive sprockets, at the rear idlers, by belt travel / wheel radius. A suspension joint's
    position is the unit's travel, negative in compression; on flat ground it is `rest_travel_m`, where the wheels
    touch the plane of base_footprint. Belts are drawn, they do not move. ``frame_prefix`` goes before every link.

    Raises
    ------
    ValueError: if the suspension cannot carry the robot at rest.
    """
    root = ElementTree.Element("robot", name=robot.name)
    for name, colour in _COLOURS.items():
        sub_element(sub_element(root, "material", name=name), "color", rgba=colour)
    sub_element(root, "link", name=f"{frame_prefix}{robot.frames.base_footprint}")
    _add_chassis(root, robot, frame_prefix)
    _add_fixed_frames(root, robot, fixed_frames(robot), frame_prefix)
    for joint_name, sign in zip(TRACK_JOINTS, (1.0, -1.0), strict=True):
        _add_sprocket(root, robot, joint_name, sign, frame_prefix)
    _add_road_wheels(root, robot, frame_prefix)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def _add_chassis(root: ElementTree.Element, robot: Robot, prefix: str) -> None:
    chassis = robot.chassis
    link = sub_element(root, "link", name=f"{prefix}{robot.frames.base_link}")
    centre = (0.0, 0.0, chassis.com_height_m - robot.base_link_height_m)
    parts = len(SENSOR_SIZES_M) + len(TRACK_JOINTS)
    add_inertial(link, chassis.sprung_mass_kg - parts * _PART_MASS_KG, Inertia(*chassis.inertia_kgm2), centre)
    size = tuple(2.0 * extent for extent in chassis.half_extents_m)
    add_box(link, (size[0], size[1], size[2]), centre, material="body", collides=True)
    for side in (1.0, -1.0):
        _add_belt(link, robot, side)


def _add_belt(link: ElementTree.Element, robot: Robot, side: float) -> None:
    """Upper and lower run of one belt and its two slanted ends."""
    tracks, thickness = robot.tracks, 0.008
    y, ground = side * 0.5 * tracks.gauge_m, -robot.base_link_height_m
    half_base = 0.5 * (tracks.wheel_count - 1) * tracks.wheel_spacing_m
    idler_bottom = ground + tracks.idler_height_m
    upper = idler_bottom + 2.0 * tracks.wheel_radius_m
    runs = [((-half_base, ground), (half_base, ground)), ((-tracks.idler_x_m, upper), (tracks.idler_x_m, upper))]
    runs += [((end * half_base, ground), (end * tracks.idler_x_m, idler_bottom)) for end in (-1.0, 1.0)]
    for (start_x, start_z), (end_x, end_z) in runs:
        length = math.hypot(end_x - start_x, end_z - start_z)
        centre = (0.5 * (start_x + end_x), y, 0.5 * (start_z + end_z) + 0.5 * thickness)
        pitch = -math.atan2(end_z - start_z, end_x - start_x)
        add_box(link, (length, tracks.belt_width_m, thickness), centre, material="rubber", rpy=(0.0, pitch, 0.0))


def _add_fixed_frames(root: ElementTree.Element, robot: Robot, frames: Iterable[FixedFrame], prefix: str) -> None:
    shapes = {getattr(robot.frames, key): size for key, size in SENSOR_SIZES_M.items()}
    for frame in frames:
        if frame.child != robot.frames.base_link:
            link = sub_element(root, "link", name=f"{prefix}{frame.child}")
            if frame.child in shapes:
                size = shapes[frame.child]
                add_inertial(link, _PART_MASS_KG, box_inertia(_PART_MASS_KG, size))
                add_box(link, size, material="metal")
        add_joint(
            root,
            f"{frame.child}_joint",
            "fixed",
            f"{prefix}{frame.parent}",
            f"{prefix}{frame.child}",
            frame.xyz_m,
            frame.rpy_rad,
        )


def _add_sprocket(root: ElementTree.Element, robot: Robot, joint_name: str, sign: float, prefix: str) -> None:
    tracks, mass = robot.tracks, _PART_MASS_KG
    name = f"{prefix}{joint_name}_sprocket"
    link = sub_element(root, "link", name=name)
    add_inertial(link, mass, cylinder_inertia(mass, tracks.wheel_radius_m, tracks.belt_width_m))
    add_cylinder(link, tracks.wheel_radius_m, tracks.belt_width_m, material="metal")
    z = tracks.idler_height_m + tracks.wheel_radius_m - robot.base_link_height_m
    origin = (-tracks.idler_x_m, sign * 0.5 * tracks.gauge_m, z)
    base = f"{prefix}{robot.frames.base_link}"
    joint = add_joint(root, joint_name, "continuous", base, name, origin, axis=(0.0, 1.0, 0.0))
    torque, speed = tracks.force_limit_n * tracks.wheel_radius_m, tracks.speed_limit_mps / tracks.wheel_radius_m
    sub_element(joint, "limit", effort=f"{torque:g}", velocity=f"{speed:g}")


def _add_road_wheels(root: ElementTree.Element, robot: Robot, prefix: str) -> None:
    tracks, mass, stops = robot.tracks, robot.chassis.unit_mass_kg, robot.suspension
    inertia = cylinder_inertia(mass, tracks.wheel_radius_m, tracks.belt_width_m)
    z = tracks.wheel_radius_m - robot.base_link_height_m + rest_travel_m(robot, stops.kind)
    for index, joint_name in enumerate(suspension_joint_names(robot)):
        side, place = divmod(index, tracks.wheel_count)
        x = (place - 0.5 * (tracks.wheel_count - 1)) * tracks.wheel_spacing_m
        y = (0.5 - side) * tracks.gauge_m
        name = f"{prefix}{joint_name.replace('suspension', 'wheel')}"
        link = sub_element(root, "link", name=name)
        add_inertial(link, mass, inertia)
        add_cylinder(link, tracks.wheel_radius_m, tracks.belt_width_m, material="rubber", collides=True)
        base = f"{prefix}{robot.frames.base_link}"
        joint = add_joint(root, joint_name, "prismatic", base, name, (x, y, z), axis=(0.0, 0.0, -1.0))
        sub_element(
            joint,
            "limit",
            lower=f"{-stops.compression_stop_m:g}",
            upper=f"{stops.extension_stop_m:g}",
            effort=f"{stops.stop_stiffness_npm * stops.compression_stop_m:g}",
            velocity="10",
        )
