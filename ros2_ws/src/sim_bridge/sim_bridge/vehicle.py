"""The simulated vehicle in its world: one rigid chassis on two belts, stepped by Bullet."""

import math
from dataclasses import dataclass

import numpy as np
import pybullet
from numpy.typing import NDArray

from robust_core.plants.x_structure import STANDARD_GRAVITY_MPS2
from sim_bridge.belts.geometry import locate
from sim_bridge.belts.parameters import BeltParameters, belt_parameters
from sim_bridge.belts.probes import HALF_THICKNESS_M, BeltProbes
from sim_bridge.belts.stability import least_rate_hz
from sim_bridge.belts.state import BeltState, new_contacts, new_state, new_workspace
from sim_bridge.belts.step import advance_belts
from sim_bridge.bodies import create_chassis, create_floor
from sim_bridge.entities import Entities
from sim_bridge.ground_friction import GroundFriction
from sim_bridge.physics_settings import PhysicsSettings
from sim_bridge.solids import Friction
from sim_bridge.vehicle_state import VehicleState
from sim_bridge.world import World
from tracked_description import Robot
from tracked_description.suspension import SuspensionKind
from tracked_types import Pose2

Array = NDArray[np.float64]


class PhysicsDivergedError(RuntimeError):
    """The state is no longer finite: a body was put where none can be, or the step is too coarse."""


@dataclass(frozen=True, slots=True)
class Snapshot:
    """A saved instant of one vehicle and its world; of use only to the vehicle that made it."""

    bullet_state: int
    belts: BeltState
    step_index: int
    entities: Entities
    revision: int
    suspension: SuspensionKind
    friction: GroundFriction


class Vehicle:
    """A tracked robot in a world, one physics step at a time.

    Parameters
    ----------
    robot, world: descriptions.
    settings: rate and suspension law.
    start: pose of base_footprint on the floor; None means the world's start called ``default``.

    Raises
    ------
    SnapThroughError: if the suspension cannot carry the robot (robust_core.plants.x_structure).
    ValueError: if its travel under the robot's weight is beyond a stop, or the rate is too low for the law.
    """

    def __init__(
        self, robot: Robot, world: World, settings: PhysicsSettings | None = None, start: Pose2 | None = None
    ) -> None:
        self.robot = robot
        self.world = world
        self.settings = settings or PhysicsSettings()
        self.period_s = 1.0 / self.settings.physics_rate_hz
        self._kind = self.settings.suspension_kind(robot)
        self._parameters = self._parameters_for(self._kind)
        self.client: int = pybullet.connect(pybullet.DIRECT)
        if self.client < 0:
            raise RuntimeError("Bullet has no room for another world; close() those no longer needed")
        self._wheels = robot.tracks.wheel_count
        self._build(start or world.start())

    def _parameters_for(self, kind: SuspensionKind) -> BeltParameters:
        needed, rate = least_rate_hz(self.robot, kind), self.settings.physics_rate_hz
        if rate < needed:
            raise ValueError(f"suspension {kind!r} needs a physics rate of at least {needed:.0f} Hz, got {rate} Hz")
        return belt_parameters(self.robot, kind)

    def _build(self, start: Pose2) -> None:
        client = self.client
        pybullet.resetSimulation(physicsClientId=client)
        pybullet.setGravity(0.0, 0.0, -STANDARD_GRAVITY_MPS2, physicsClientId=client)
        pybullet.setTimeStep(self.period_s, physicsClientId=client)
        pybullet.setPhysicsEngineParameter(deterministicOverlappingPairs=1, physicsClientId=client)
        create_floor(client)
        self._chassis = create_chassis(client, self.robot)
        self.entities = Entities(client)
        for solid in self.world.solids():
            self.entities.spawn(solid)
        self._friction = GroundFriction.of_world(self.world, self.robot)
        self._apply_friction()
        self._probes = BeltProbes(client, self._parameters, self._wheels)
        self._belts = new_state(self._wheels, self._parameters.rest_travel)
        self._work = new_workspace(self._wheels)
        self._contacts = new_contacts()
        self.contact_count = 0
        self.step_index = 0
        self.yaw_torque_nm = 0.0
        """Torque about the vertical by which somebody turns the robot, held until it is changed."""
        self.place(start)

    def place(self, pose: Pose2) -> None:
        """Put the robot at rest on the floor at ``pose``; its belts keep their travel, the world stays as it is."""
        travelled = self._belts.belt_travel.copy()
        self._belts.assign(new_state(self._wheels, self._parameters.rest_travel))
        self._belts.belt_travel[:] = travelled
        position = (pose.x_m, pose.y_m, self.robot.chassis.com_height_m)
        orientation = pybullet.getQuaternionFromEuler((0.0, 0.0, pose.yaw_rad))
        pybullet.resetBasePositionAndOrientation(self._chassis, position, orientation, physicsClientId=self.client)
        pybullet.resetBaseVelocity(self._chassis, (0.0,) * 3, (0.0,) * 3, physicsClientId=self.client)
        self._read_chassis()

    def _read_chassis(self) -> None:
        position, orientation = pybullet.getBasePositionAndOrientation(self._chassis, physicsClientId=self.client)
        velocity, angular = pybullet.getBaseVelocity(self._chassis, physicsClientId=self.client)
        self._body: tuple[float, ...] = (*position, *orientation, *velocity, *angular)

    def step(self, left_target_mps: float, right_target_mps: float) -> None:
        """Advance by one physics step with the drives aiming at these belt speeds (m/s).

        Raises
        ------
        ValueError: if a target is not finite.
        PhysicsDivergedError: if the state is no longer finite afterwards.
        """
        if not (math.isfinite(left_target_mps) and math.isfinite(right_target_mps)):
            raise ValueError(f"belt speed targets must be finite, got {left_target_mps!r}, {right_target_mps!r}")
        client, work, contacts = self.client, self._work, self._contacts
        self.entities.refresh()
        pairs = locate(
            self._parameters,
            self._belts,
            work,
            self._body,
            self.entities.boxes,
            self._probes.half_lengths,
            HALF_THICKNESS_M,
        )
        touching = self._probes.collect(work, pairs, self.entities, contacts) if pairs else 0
        self.contact_count = advance_belts(
            self._parameters,
            self._belts,
            work,
            contacts,
            touching,
            self._friction.zones,
            self._body,
            float(left_target_mps),
            float(right_target_mps),
            self.period_s,
        )
        wrench = work.wrench.tolist()
        pybullet.applyExternalForce(
            self._chassis, -1, wrench[:3], self._body[:3], pybullet.WORLD_FRAME, physicsClientId=client
        )
        torque = (wrench[3], wrench[4], wrench[5] + self.yaw_torque_nm)
        pybullet.applyExternalTorque(self._chassis, -1, torque, pybullet.WORLD_FRAME, physicsClientId=client)
        if touching:
            self._probes.push_back(self.entities, contacts)
        pybullet.stepSimulation(physicsClientId=client)
        self._read_chassis()
        self.step_index += 1
        if not math.isfinite(sum(self._body)):
            raise PhysicsDivergedError(f"the chassis' state is not finite after step {self.step_index}")

    @property
    def state(self) -> VehicleState:
        """State after the last step."""
        body = np.array(self._body)
        x, y, z, w = self._body[3:7]
        rotation = np.array(pybullet.getMatrixFromQuaternion((x, y, z, w))).reshape(3, 3)
        return VehicleState(
            step_index=self.step_index,
            position_m=body[:3],
            quaternion=body[3:7],
            rotation=rotation,
            velocity_mps=body[7:10],
            angular_velocity_radps=body[10:],
            belt_travel_m=self._belts.belt_travel.copy(),
            belt_speed_mps=self._belts.belt_speed.copy(),
            motor_force_n=self._belts.motor_force.copy(),
            suspension_travel_m=self._belts.travel.ravel().copy(),
            com_height_m=self.robot.chassis.com_height_m,
        )

    @property
    def belt_loads_n(self) -> Array:
        """Normal load of each bar of the belts in the last step, (2, wheels + 1), left and right, rear to front."""
        return self._work.load.copy()

    @property
    def suspension(self) -> SuspensionKind:
        """The suspension law in force."""
        return self._kind

    def set_suspension(self, kind: SuspensionKind) -> None:
        """Change the suspension law in place; the wheels stay where they are.

        Raises
        ------
        SnapThroughError, ValueError: if that law cannot carry the robot; nothing has changed then.
        """
        parameters = self._parameters_for(kind)
        self._belts.travel[:] += parameters.rest_travel - self._parameters.rest_travel
        self._parameters, self._kind = parameters, kind
        self._apply_friction()

    def set_friction(self, friction: Friction, zone: str | None = None) -> None:
        """Change the friction of one zone of the world, or without a name that of everything outside zones.

        Raises
        ------
        ValueError: if the world has no such zone.
        """
        self._friction = self._friction.changed(friction, zone)
        self._apply_friction()

    def _apply_friction(self) -> None:
        self._parameters = self._parameters._replace(
            friction_longitudinal=self._friction.floor.longitudinal, friction_lateral=self._friction.floor.lateral
        )

    def reset(self, start: Pose2 | None = None) -> None:
        """Build the world anew; afterwards nothing differs from a fresh vehicle, entities included."""
        self._kind = self.settings.suspension_kind(self.robot)
        self._parameters = self._parameters_for(self._kind)
        self._build(start or self.world.start())

    def snapshot(self) -> Snapshot:
        """Save this instant. Give it back to `discard` when it is no longer needed."""
        saved: int = pybullet.saveState(physicsClientId=self.client)
        return Snapshot(
            bullet_state=saved,
            belts=self._belts.copy(),
            step_index=self.step_index,
            entities=self.entities,
            revision=self.entities.revision,
            suspension=self._kind,
            friction=self._friction,
        )

    def restore(self, snapshot: Snapshot) -> None:
        """Return to a saved instant; what follows is bit-identical to what followed it.

        Raises
        ------
        ValueError: if entities were spawned or deleted since, or the vehicle was reset.
        """
        if snapshot.entities is not self.entities or snapshot.revision != self.entities.revision:
            raise ValueError("entities were spawned or deleted, or the vehicle was reset, since the snapshot")
        pybullet.restoreState(stateId=snapshot.bullet_state, physicsClientId=self.client)
        self._belts.assign(snapshot.belts)
        self._kind, self._friction, self.step_index = snapshot.suspension, snapshot.friction, snapshot.step_index
        self._parameters = self._parameters_for(self._kind)
        self._apply_friction()
        self.entities.refresh_all()
        self._read_chassis()

    def discard(self, snapshot: Snapshot) -> None:
        """Free what a snapshot holds."""
        pybullet.removeState(snapshot.bullet_state, physicsClientId=self.client)

    def close(self) -> None:
        """Free the world; the vehicle is of no use afterwards."""
        if self.client >= 0:
            pybullet.disconnect(physicsClientId=self.client)
            self.client = -1
