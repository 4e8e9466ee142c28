"""The simulator as a plant of the lab."""

from collections.abc import Iterable, Mapping
from typing import Any

from sim_bridge.faults import Fault, kind_called, sensor_called
from sim_bridge.sensor_suite import SensorBatch
from tracked_description import Robot
from tracked_lab.belt_ground import BeltGround, YawObstacle
from tracked_lab.conditions import Conditions
from tracked_lab.simulation import make_simulator
from tracked_report.scenario import Fault as PlannedFault
from tracked_types import Pose2, VelocityCommand, seconds_between, to_nanoseconds


class BeltWorld:
    """Belts on a ground, stepped by the physics engine, with the sensors of the simulated robot.

    Parameters
    ----------
    parameters: of the node sim_bridge.
    faults: of the scenario.
    conditions: of the run; of these the ground's.
    begin_s: when the reference begins to move, for the obstacle.

    Raises
    ------
    UnknownParameterError: if a parameter is not the simulator's.
    FaultRefused, CheckedFileError, ValueError: if faults, conditions, world, start or a value cannot be used.
    """

    def __init__(
        self,
        robot: Robot,
        parameters: Mapping[str, Any],
        faults: Iterable[PlannedFault] = (),
        conditions: Conditions | None = None,
        begin_s: float = 0.0,
    ) -> None:
        conditions = conditions or Conditions()
        seed = int(parameters.get("seed", 0))
        ground = BeltGround.under(conditions, seed)
        self._obstacle = YawObstacle.of_seed(seed, begin_s) if conditions.obstacle else None
        self._simulator = simulator = make_simulator(robot, parameters, ground.moved)
        try:
            ground.apply(simulator.vehicle, simulator.world, robot)
            for planned in faults:
                simulator.inject(_fault(planned))
        except ValueError:
            simulator.close()
            raise

    @property
    def stamp_ns(self) -> int:
        """Simulated time."""
        return self._simulator.stamp_ns

    @property
    def start(self) -> Pose2:
        """Where in the world the robot stood at time zero."""
        return self._simulator.start

    def advance(self) -> SensorBatch:
        """Run to the next tick of the IMU."""
        simulator, obstacle = self._simulator, self._obstacle
        if obstacle is None:
            return simulator.advance()
        while True:
            vehicle, now_s = simulator.vehicle, seconds_between(simulator.stamp_ns, 0)
            if obstacle.begin_s - 0.1 < now_s < obstacle.end_s + 0.1:
                yaw_rate = float(vehicle.state.angular_velocity_radps[2])
                vehicle.yaw_torque_nm = obstacle.torque_nm(now_s, yaw_rate)
            batch = simulator.step()
            if batch is not None:
                return batch

    def submit(self, command: VelocityCommand) -> None:
        """Take a command; raises CommandRefused as the simulator does."""
        self._simulator.submit(command)

    def close(self) -> None:
        """Free the world."""
        self._simulator.close()


def _fault(planned: PlannedFault) -> Fault:
    start_ns = to_nanoseconds(planned.at_s)
    end_ns = None if planned.duration_s is None else start_ns + to_nanoseconds(planned.duration_s)
    return Fault(sensor_called(planned.target), kind_called(planned.kind), start_ns, end_ns, planned.value)
