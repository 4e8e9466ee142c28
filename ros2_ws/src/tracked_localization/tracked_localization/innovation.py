"""What a sensor said beyond what was expected."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Innovation:
    """Difference between a fused reading and its prediction, and the variance the filter gave it.

    sensor: ``imu`` (rad/s) or ``tracks`` (m). at_rest: the robot stood, and the reading was one of the gyro's bias.
    """

    stamp_ns: int
    sensor: str
    value: float
    variance: float
    at_rest: bool = False

    @property
    def normalised_square(self) -> float:
        """Squared innovation over its variance (NIS); its mean is 1 for a consistent filter."""
        return self.value * self.value / self.variance
