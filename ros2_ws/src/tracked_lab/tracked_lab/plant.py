"""What moves and is measured: one interface for every plant."""

from typing import Protocol

from tracked_types import BodyState, ImuSample, Pose2, Slip, TrackSample, VelocityCommand


class PlantBatch(Protocol):
    """What the sensors, and an ideal outside observer, deliver at one tick of the IMU."""

    @property
    def stamp_ns(self) -> int:
        """Stamp of the tick."""

    @property
    def imu(self) -> tuple[ImuSample, ...]:
        """Samples that arrive at this tick."""

    @property
    def tracks(self) -> tuple[TrackSample, ...]:
        """Samples that arrive at this tick."""

    @property
    def truth(self) -> tuple[BodyState, ...]:
        """True state in the world, at the rate of the odometry."""

    @property
    def truth_slip(self) -> tuple[Slip, ...]:
        """True slip over the period of the odometry that ends at its stamp."""


class Plant(Protocol):
    """A robot on its ground, advanced tick by tick of its IMU.

    Equal seeds and commands give bit-identical batches.
    """

    @property
    def stamp_ns(self) -> int:
        """Simulated time."""

    @property
    def start(self) -> Pose2:
        """Where in the world the robot stood at time zero."""

    def advance(self) -> PlantBatch:
        """Run to the next tick."""

    def submit(self, command: VelocityCommand) -> None:
        """Take a command; it acts at its stamp plus the transport delay, at once if that has passed.

        Raises
        ------
        CommandRefused: of sim_bridge.command_intake, if the base would not take it.
        """

    def close(self) -> None:
        """Free what the plant holds; it is of no use afterwards."""
