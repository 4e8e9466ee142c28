"""How lively a speed is at the moment: process noise that follows the innovations."""


class AdaptiveNoise:
    """Intensity of the random walk that drives a speed, learnt from the filter's own surprises.

    A robot cruises most of the time and manoeuvres some of it. One fixed intensity would call the
    filter too sure in one state or too timid in the other; the mean squared innovation says which it is.

    Parameters
    ----------
    floor, ceiling: bounds of the intensity, (unit of the speed)^2 / s.
    memory: number of innovations over which the mean is taken.
    """

    def __init__(self, floor: float, ceiling: float, memory: float) -> None:
        self._floor = floor
        self._ceiling = ceiling
        self._weight = 1.0 / memory
        self._mean = ceiling
        self.intensity = ceiling

    def restart(self) -> None:
        """Forget: anything may happen next."""
        self._mean = self.intensity = self._ceiling

    def observe(self, squared_innovation: float, variance: float, gain: float) -> None:
        """Learn from one innovation.

        ``variance`` is what the filter expected, of which ``gain`` times the intensity came from this noise.
        """
        # Unbiased for the intensity, hence negative at times; only its mean is clipped.
        sample = self.intensity + (squared_innovation - variance) / gain
        self._mean += self._weight * (min(sample, 4.0 * self._ceiling) - self._mean)
        self.intensity = min(max(self._mean, self._floor), self._ceiling)
