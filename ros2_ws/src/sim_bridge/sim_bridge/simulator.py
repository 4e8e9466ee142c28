"""The simulated robot as a whole: commands in, sensor samples out, on integer clocks."""

from dataclasses import dataclass, field
from functools import partial

from sim_bridge.command_intake import CommandIntake, IntakeSettings
from sim_bridge.faults import Fault, Sensor
from sim_bridge.physics_settings import PhysicsSettings
from sim_bridge.sensor_suite import SensorBatch, SensorSuite, VehicleMotion
from sim_bridge.sensors.lidar import SCAN_MODES
from sim_bridge.sensors.mounting import PointMotion
from sim_bridge.sensors.rays import cast_rays
from sim_bridge.track_speeds import track_targets
from sim_bridge.vehicle import Vehicle
from sim_bridge.walkers import Walking
from sim_bridge.world import World
from tracked_description import Robot
from tracked_types import PeriodGrid, Pose2, VelocityCommand
from tracked_types.setting import check_settings, setting


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatorSettings:
    """What can be chosen about the simulation besides robot and world."""

    physics: PhysicsSettings = field(default_factory=PhysicsSettings)
    lidar_mode: str = setting("rolling", "Beams of a scan one after the other, or all at its stamp", choices=SCAN_MODES)

    def __post_init__(self) -> None:
        check_settings(self)


class Simulator:
    """Robot in a world, advanced tick by tick of its IMU.

    Simulated time is a count of physics steps; every sensor instant is a whole number of them, so nothing
    drifts, and the same seed and commands give bit-identical samples. The sensors of a tick see the state
    after its last step.

    Raises
    ------
    ValueError: if the sensor rates do not divide the physics rate, or the robot cannot stand on its suspension.
    """

    def __init__(
        self,
        robot: Robot,
        world: World,
        settings: SimulatorSettings | None = None,
        *,
        seed: int = 0,
        start: Pose2 | None = None,
    ) -> None:
        self.robot = robot
        self.world = world
        self._settings = settings or SimulatorSettings()
        self.start = start or world.start()
        step_rate_hz, tick_rate_hz = self._settings.physics.physics_rate_hz, robot.imu.rate_hz
        if step_rate_hz % tick_rate_hz:
            raise ValueError(f"the physics rate must be a multiple of {tick_rate_hz} Hz (IMU), got {step_rate_hz}")
        self._steps_per_tick = step_rate_hz // tick_rate_hz
        self.step_s = 1.0 / step_rate_hz
        self._grid = PeriodGrid(step_rate_hz)
        self._steps = 0
        self.intake = CommandIntake(IntakeSettings.from_robot(robot))
        self.vehicle = Vehicle(robot, world, self._settings.physics, self.start)
        self.sensors = SensorSuite(robot, self._settings.lidar_mode, seed, self._motion())
        self._walking = Walking(world.walkers)

    @property
    def stamp_ns(self) -> int:
        """Simulated time."""
        return self._grid.stamp_ns(self._steps)

    @property
    def next_tick_ns(self) -> int:
        """Simulated time at the end of the present tick."""
        return self._grid.stamp_ns((self._steps // self._steps_per_tick + 1) * self._steps_per_tick)

    def warm_up(self) -> None:
        """Load, and if need be compile, the code of the physics now instead of in the first step."""
        self.vehicle.step(0.0, 0.0)
        self.vehicle.reset(self.start)

    def submit(self, command: VelocityCommand) -> None:
        """Take a command; it acts at its stamp plus the transport delay.

        Raises
        ------
        CommandRefused: see `CommandIntake.submit`; the refusal is counted in ``intake.refused``.
        """
        self.intake.submit(command, self.stamp_ns)

    def advance(self) -> SensorBatch:
        """Run to the end of the present tick; what the sensors deliver there."""
        while (batch := self.step()) is None:
            pass
        return batch

    def step(self) -> SensorBatch | None:
        """One step of the physics; at the end of a tick, what the sensors deliver."""
        twist = self.intake.update(self.stamp_ns, self.step_s)
        self.vehicle.step(*track_targets(twist, self.robot.tracks))
        self._steps += 1
        tick, rest = divmod(self._steps, self._steps_per_tick)
        if rest:
            return None
        if self.world.walkers:
            x, y, _ = self.vehicle.state.position_m.tolist()
            self._walking.move(self.vehicle.entities, self.stamp_ns, (x, y))
        return self.sensors.update(self._motion(), tick, partial(cast_rays, self.vehicle.client))

    def reset(self, seed: int) -> None:
        """Robot, world and sensors as they were at the start, with the noise of ``seed``; time goes on."""
        self.vehicle.reset(self.start)
        self.intake.reset()
        self.sensors = SensorSuite(self.robot, self._settings.lidar_mode, seed, self._motion())

    def place_robot(self, pose: Pose2) -> None:
        """Put the robot at rest at ``pose`` on the floor; sensors do not take it for movement."""
        self.vehicle.place(pose)
        self.sensors.restart(self._motion())

    def inject(self, fault: Fault) -> None:
        """Disturb a sensor from now or later on."""
        self.sensors.inject(fault)

    def end_faults(self, sensor: Sensor) -> None:
        """End the faults of one sensor."""
        self.sensors.end_faults(sensor)

    def close(self) -> None:
        """Free the world; the simulator is of no use afterwards."""
        self.vehicle.close()

    def _motion(self) -> VehicleMotion:
        state = self.vehicle.state
        chassis = PointMotion(state.position_m, state.rotation, state.velocity_mps, state.angular_velocity_radps)
        left, right = state.belt_travel_m
        return VehicleMotion(chassis, float(left), float(right), state.suspension_travel_m)
