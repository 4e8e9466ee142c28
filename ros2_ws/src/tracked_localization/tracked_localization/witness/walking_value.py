"""A number that changes slowly, or now and then at once, and is measured."""

from dataclasses import dataclass

_SURPRISE = 9.0


@dataclass(slots=True)
class WalkingValue:
    """Kalman filter of one random walk; a measurement beyond three standard deviations means that it has jumped.

    value, variance: what is known. walk_sqrt_s: standard deviation of its change in a second. most_variance: as unsure
    as one can be; without measurements the variance grows up to it.
    """

    value: float
    variance: float
    walk_sqrt_s: float
    most_variance: float

    def pass_time(self, duration_s: float) -> None:
        """Let time pass: the variance grows."""
        self.variance = min(self.variance + self.walk_sqrt_s**2 * duration_s, self.most_variance)

    def measure(self, measured: float, variance: float) -> None:
        """Take a measurement in."""
        innovation = measured - self.value
        if innovation**2 > _SURPRISE * (self.variance + variance):
            self.variance = max(self.variance, min(innovation**2, self.most_variance))
        gain = self.variance / (self.variance + variance)
        self.value += gain * innovation
        self.variance *= 1.0 - gain
