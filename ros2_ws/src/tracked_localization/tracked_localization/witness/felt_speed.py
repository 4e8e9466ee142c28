"""Forward speed as the accelerometer feels it change."""

import math
from collections import deque

from tracked_types import to_nanoseconds

_GRAVITY_MPS2 = 9.80665
_LEVELLING_S = 2.0


class FeltSpeed:
    """Speed now, from a speed believed a moment ago and the acceleration since.

    Tilt is taken out by the pitch that the gyro has seen come, and slower by levelling while the belts run steadily.
    An accelerometer is no witness for longer than its ``window_s``.
    """

    def __init__(self, window_s: float = 0.5) -> None:
        self._window_ns = to_nanoseconds(window_s)
        self.clear()

    def clear(self) -> None:
        """Forget everything."""
        self._pitch = 0.0
        self._offset: float | None = None
        self._believed: deque[tuple[int, float, float]] = deque()
        self._gained = 0.0

    def add_imu(self, duration_s: float, forward_mps2: float, pitch_rate_radps: float, *, steady: bool) -> None:
        """Mean specific force along, and pitch rate (nose down positive), over ``duration_s``.

        ``steady``: the belts do not change their speed, so that what is felt for long is gravity and bias.
        """
        keep = math.exp(-duration_s / _LEVELLING_S) if steady else 1.0
        self._pitch += pitch_rate_radps * duration_s
        level = forward_mps2 + _GRAVITY_MPS2 * math.sin(self._pitch)
        if self._offset is None:
            self._offset = level
        excess = level - self._offset
        # Pitch fades, and the offset takes its place: then the end of a slope is no acceleration either.
        faded = keep * self._pitch
        self._offset += _GRAVITY_MPS2 * (math.sin(faded) - math.sin(self._pitch)) + (1.0 - keep) * excess
        self._pitch = faded
        self._gained += excess * duration_s

    def doubt(self) -> None:
        """What was believed of the last moments was wrong."""
        self._believed.clear()

    def believe(self, stamp_ns: int, speed_mps: float) -> None:
        """What the forward speed is thought to be now; it counts from a window later on."""
        self._believed.append((stamp_ns, speed_mps, self._gained))
        while len(self._believed) > 1 and self._believed[1][0] <= stamp_ns - self._window_ns:
            self._believed.popleft()

    @property
    def gained_mps(self) -> float:
        """Change of speed felt over the window."""
        return self._gained - self._believed[0][2] if self._believed else 0.0

    @property
    def speed_mps(self) -> float | None:
        """Speed now; None before anything was believed."""
        return self._believed[0][1] + self.gained_mps if self._believed else None
