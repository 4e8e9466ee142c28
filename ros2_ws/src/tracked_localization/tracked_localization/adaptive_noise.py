"""How lively a motion is at the moment: process noise that follows the innovations."""

import math

_MOST = 400.0
_START = 0.01
_LONGEST_CAUTION = 200


class AdaptiveNoise:
    """Intensity of the noise that drives a motion, learnt from the filter's own surprises.

    A robot cruises most of the time and manoeuvres some of it. One fixed intensity would make the filter
    too sure in one state or too timid in the other. Each normalised innovation above 1 raises the
    intensity, each below lowers it, so that their mean stays at 1 while the intensity is within its bounds.

    Parameters
    ----------
    floor, ceiling: bounds of the intensity.
    rate: change of its logarithm per unit of surprise.
    """

    def __init__(self, floor: float, ceiling: float, rate: float) -> None:
        self._lowest = math.log(floor)
        self._highest = math.log(ceiling)
        self._rate = rate
        self.restart()

    def restart(self) -> None:
        """Forget: the next moments are neither rest nor the wildest manoeuvre."""
        self._level = self._highest + math.log(_START)
        self.intensity = math.exp(self._level)

    def expect_anything(self) -> None:
        """Nobody watches this motion: it may do its worst."""
        self._level = self._highest
        self.intensity = math.exp(self._level)

    def observe(self, normalised_square: float) -> None:
        """Learn from one innovation, squared and divided by the variance that the filter expected."""
        self._level += self._rate * (min(normalised_square, _MOST) - 1.0)
        self._level = min(max(self._level, self._lowest), self._highest + _LONGEST_CAUTION * self._rate)
        self.intensity = math.exp(min(self._level, self._highest))
