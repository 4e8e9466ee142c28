"""What an operator may do to the world: look up, place, spawn and delete bodies, change friction and suspension."""

from typing import get_args

import numpy as np
from numpy.typing import NDArray

from sim_bridge.entities import EntityError, EntityState
from sim_bridge.simulator import Simulator
from sim_bridge.solids import Box, Cylinder, Friction, Vector, solids_of
from tracked_description.suspension import SuspensionKind
from tracked_types import Pose2
from tracked_types.checked_yaml import check_content


class UnknownNameError(ValueError):
    """The world has nothing of this name; the text lists what it has."""


class WorldControl:
    """The world of a simulator by names; the robot is an entity of it, under the name in its robot file.

    Everything acts between two physics steps and is undone by `Simulator.reset`. All methods raise ValueError
    with the reason if something makes no sense, and then change nothing.
    """

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator

    @property
    def robot_name(self) -> str:
        """Name of the robot among the entities."""
        return self._simulator.robot.name

    @property
    def entity_names(self) -> tuple[str, ...]:
        """The robot, then the bodies of the world in order of spawning."""
        return (self.robot_name, *self._simulator.vehicle.entities.names)

    def entity_state(self, name: str) -> EntityState:
        """State of a body's centre, or of the robot's base_footprint, in the world.

        Raises
        ------
        UnknownNameError: if there is none of this name.
        """
        self._require(name)
        if name != self.robot_name:
            return self._simulator.vehicle.entities.state(name)
        state = self._simulator.vehicle.state
        return EntityState(
            _vector(state.base_position_m),
            _vector(state.roll_pitch_yaw_rad),
            _vector(state.point_velocity_mps(np.zeros(3))),
            _vector(state.angular_velocity_radps),
        )

    def set_entity_state(self, name: str, state: EntityState) -> None:
        """Put a body somewhere; the robot is put at rest on the floor, of its pose only x, y and yaw count.

        Raises
        ------
        UnknownNameError: if there is none of this name.
        EntityError: if a number is not finite.
        """
        self._require(name)
        if name != self.robot_name:
            self._simulator.vehicle.entities.set_state(name, state)
            return
        pose = Pose2(state.position_m[0], state.position_m[1], state.roll_pitch_yaw_rad[2])
        if not np.all(np.isfinite(pose.as_array())):
            raise EntityError(f"state of {name!r} is not finite: {state}")
        self._simulator.place_robot(pose)

    def spawn(
        self, name: str, shape: str, size_m: Vector, mass_kg: float, position_m: Vector, roll_pitch_yaw_rad: Vector
    ) -> None:
        """Add a box (edge lengths) or a cylinder (diameter, diameter, height); without mass it cannot be moved."""
        if name == self.robot_name:
            raise EntityError(f"{name!r} is the robot")
        content = {
            "name": name,
            "shape": shape,
            "position_m": position_m,
            "roll_pitch_yaw_rad": roll_pitch_yaw_rad,
            "mass_kg": mass_kg if mass_kg != 0.0 else None,
        }
        length, width, height = size_m
        checked: Box | Cylinder
        if shape == "box":
            checked = check_content(Box, content | {"size_m": size_m}, f"entity {name!r}")
        elif shape != "cylinder":
            raise EntityError(f"shape must be box or cylinder, got {shape!r}")
        elif length != width:
            raise EntityError(f"a cylinder's first two sizes are its diameter, got {length:g} and {width:g} m")
        else:
            dimensions = {"radius_m": 0.5 * length, "height_m": height}
            checked = check_content(Cylinder, content | dimensions, f"entity {name!r}")
        for solid in solids_of(checked):
            self._simulator.vehicle.entities.spawn(solid)

    def delete(self, name: str) -> None:
        """Remove a body of the world; the robot stays."""
        self._require(name)
        if name == self.robot_name:
            raise EntityError("the robot cannot be deleted")
        self._simulator.vehicle.entities.delete(name)

    def set_friction(self, zone: str, longitudinal: float, lateral: float) -> None:
        """Change the friction of a zone of the world, or, with an empty name, of the floor around all zones."""
        zones = [known.name for known in self._simulator.world.friction_zones]
        if zone and zone not in zones:
            raise UnknownNameError(f"no friction zone {zone!r}; there are: {', '.join(zones) or 'none'}")
        content = {"longitudinal": longitudinal, "lateral": lateral}
        self._simulator.vehicle.set_friction(check_content(Friction, content, "friction"), zone or None)

    def set_suspension(self, kind: str) -> None:
        """Change the suspension law: qzs, linear or locked; one that cannot carry the robot is refused."""
        kinds: tuple[SuspensionKind, ...] = get_args(SuspensionKind)
        for known in kinds:
            if kind == known:
                self._simulator.vehicle.set_suspension(known)
                return
        raise UnknownNameError(f"no suspension {kind!r}; there are: {', '.join(kinds)}")

    def _require(self, name: str) -> None:
        if name not in self.entity_names:
            raise UnknownNameError(f"no entity {name!r}; there are: {', '.join(self.entity_names)}")


def _vector(values: NDArray[np.float64]) -> Vector:
    x, y, z = values.tolist()
    return (x, y, z)
