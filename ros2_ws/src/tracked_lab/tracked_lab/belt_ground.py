"""What conditions make of the belt world: friction, start and an obstacle, drawn by the seed of the run."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.random import SeedSequence

from sim_bridge.ground_friction import GroundFriction
from sim_bridge.solids import Friction
from sim_bridge.vehicle import Vehicle
from sim_bridge.world import World
from tracked_description import Robot
from tracked_lab.conditions import Conditions
from tracked_lab.kinematic_ground import Ground
from tracked_types import Pose2
from tracked_types.checked_yaml import check_content

_STREAM = 0x62656C74  # keeps these draws apart from those that others make from the same seed
FRICTION_SPREAD, START_SPREAD_M, START_SPREAD_RAD = 0.15, 0.03, 0.02
GRIP_NMS = 100.0
STRONGEST_NM = 40.0


@dataclass(frozen=True, slots=True)
class BeltGround:
    """Factors of the world's friction along and across the belts, and where the robot stands.

    moved: in the frame of the start pose.
    """

    along: float = 1.0
    across: float = 1.0
    moved: Pose2 | None = None

    @classmethod
    def under(cls, conditions: Conditions, seed: int) -> "BeltGround":
        """The ground of one run.

        The severity of slip multiplies the friction across the belts: what resists turning. The yaw rate lost grows
        about in proportion (2.0 to 2.3 times at severity 2); straight ahead these belts do not slip. Varied ground
        draws both frictions within 15 % and the start within 3 cm and 0.02 rad.

        Raises
        ------
        ValueError: if the severity is zero, for the belts' law needs some friction.
        """
        severity = conditions.slip_severity
        if severity <= 0.0:
            raise ValueError("slip_severity must be above zero on belts; without slip there is the kinematic plant")
        if not conditions.varied_ground:
            return cls(across=severity)
        draws = np.random.default_rng(SeedSequence([seed, _STREAM])).uniform(-1.0, 1.0, 5).tolist()
        along, across, x, y, yaw = draws
        return cls(
            1.0 + FRICTION_SPREAD * along,
            severity * (1.0 + FRICTION_SPREAD * across),
            Pose2(START_SPREAD_M * x, START_SPREAD_M * y, START_SPREAD_RAD * yaw),
        )

    def apply(self, vehicle: Vehicle, world: World, robot: Robot) -> None:
        """Give floor and zones their friction.

        Raises
        ------
        CheckedFileError: if a coefficient is beyond what the simulator takes.
        """
        if self.along == self.across == 1.0:
            return
        zones = {zone.name: zone.friction for zone in world.friction_zones}
        for name, friction in ((None, GroundFriction.of_world(world, robot).floor), *zones.items()):
            scaled = {"longitudinal": self.along * friction.longitudinal, "lateral": self.across * friction.lateral}
            vehicle.set_friction(check_content(Friction, scaled, "slip_severity: friction"), name)


@dataclass(frozen=True, slots=True)
class YawObstacle:
    """Something that takes hold of the robot and turns it: the sudden pose change of (5.3.2).

    Between begin_s and end_s it grips as sin(pi t) does and turns at turn_radps, with a torque in proportion to the
    lack of yaw rate and never beyond STRONGEST_NM: stronger than the tracks' friction, weaker than a wall.
    """

    turn_radps: float
    begin_s: float
    end_s: float

    @classmethod
    def of_seed(cls, seed: int, begin_s: float) -> "YawObstacle":
        """The same turn and times as on the kinematic plant's ground of this seed."""
        ground = Ground.of_seed(seed, obstacle=True, begin_s=begin_s)
        return cls(ground.kick_radps, *ground.kick_s)

    def torque_nm(self, time_s: float, yaw_rate_radps: float) -> float:
        """Torque about the vertical on a robot that turns at ``yaw_rate_radps``."""
        if not self.begin_s < time_s < self.end_s:
            return 0.0
        grip = GRIP_NMS * math.sin(math.pi * (time_s - self.begin_s) / (self.end_s - self.begin_s))
        torque = grip * (self.turn_radps - yaw_rate_radps)
        return min(max(torque, -STRONGEST_NM), STRONGEST_NM)
