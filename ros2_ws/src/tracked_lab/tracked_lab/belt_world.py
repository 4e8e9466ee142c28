"""The simulator as a plant of the lab."""

from collections.abc import Iterable, Mapping
from typing import Any

from sim_bridge.faults import Fault, kind_called, sensor_called
from sim_bridge.sensor_suite import SensorBatch
from tracked_description import Robot
from tracked_lab.conditions import Conditions
from tracked_lab.simulation import make_simulator
from tracked_report.scenario import Fault as PlannedFault
from tracked_types import Pose2, VelocityCommand, to_nanoseconds


class BeltWorld:
    """Belts on a ground, stepped by the physics engine, with the sensors of the simulated robot.

    Raises
    ------
    UnknownParameterError: if a parameter is not the simulator's.
    FaultRefused, CheckedFileError, ValueError: if faults, world, start or a value cannot be used.
    """

    def __init__(
        self,
        robot: Robot,
        parameters: Mapping[str, Any],
        faults: Iterable[PlannedFault] = (),
        conditions: Conditions | None = None,
    ) -> None:
        self._simulator = make_simulator(robot, parameters)
        try:
            for planned in faults:
                self._simulator.inject(_fault(planned))
        except ValueError:
            self._simulator.close()
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
        return self._simulator.advance()

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
