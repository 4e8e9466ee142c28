"""Which sensor is to blame, for what, and since when."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

from tracked_types import to_nanoseconds

IMU = "imu"
TRACKS = "tracks"
POSE = "pose"


class Fault(Enum):
    """What a sensor can do wrong."""

    NOT_FINITE = "not a finite number"
    IMPLAUSIBLE = "beyond what the robot can do"
    JUMP = "jumps"
    STUCK = "stuck"
    BIASED = "turns at rest"
    SILENT = "silent"
    LOSSY = "loses samples"
    BAD_STAMP = "stamps are wrong"
    BAD_COVARIANCE = "covariance is none"
    WRONG_FRAME = "in another frame"


@dataclass(frozen=True, slots=True)
class Culprit:
    """A sensor that misbehaves: from ``since_ns`` on, for the last time at ``last_ns``."""

    sensor: str
    fault: Fault
    since_ns: int
    last_ns: int

    def __str__(self) -> str:
        return f"{self.sensor}: {self.fault.value}"


@dataclass(frozen=True, slots=True)
class Health:
    """State of the filter's inputs at one instant.

    culprits: sensors blamed now. counts: offences since the start, by sensor and fault, and samples that
    were merely late or sent twice. advancing: the pose follows at least one sensor. standing: at rest.
    """

    stamp_ns: int
    culprits: tuple[Culprit, ...]
    counts: Mapping[str, int]
    advancing: bool
    standing: bool

    def blames(self, sensor: str) -> bool:
        """Whether ``sensor`` is blamed for anything."""
        return any(culprit.sensor == sensor for culprit in self.culprits)

    @property
    def summary(self) -> str:
        """One line for people."""
        if self.culprits:
            return "; ".join(str(culprit) for culprit in self.culprits)
        if not self.advancing:
            return "no sensor has spoken yet"
        return "at rest" if self.standing else "fusing all sensors"


class BlameList:
    """Remembers offences; a sensor stays blamed for ``hold_s`` after its last one."""

    def __init__(self, hold_s: float) -> None:
        self._hold_ns = to_nanoseconds(hold_s)
        self._culprits: dict[tuple[str, Fault], Culprit] = {}
        self.counts: Counter[str] = Counter()

    def blame(self, sensor: str, fault: Fault, stamp_ns: int) -> None:
        """Note one offence."""
        self.count(sensor, fault.value)
        self._accuse(sensor, fault, stamp_ns)

    def keep_blaming(self, sensor: str, fault: Fault, stamp_ns: int) -> None:
        """Note that a state lasts; it counts as one offence from beginning to end."""
        if not self._accuse(sensor, fault, stamp_ns):
            self.count(sensor, fault.value)

    def count(self, sensor: str, what: str) -> None:
        """Count something that is no offence by itself."""
        self.counts[f"{sensor}: {what}"] += 1

    def _accuse(self, sensor: str, fault: Fault, stamp_ns: int) -> bool:
        known = self._culprits.get((sensor, fault))
        ongoing = known is not None and stamp_ns - known.last_ns <= self._hold_ns
        since = known.since_ns if known is not None and ongoing else stamp_ns
        self._culprits[sensor, fault] = Culprit(sensor, fault, since, stamp_ns)
        return ongoing

    def culprits(self, now_ns: int) -> tuple[Culprit, ...]:
        """Everybody blamed at ``now_ns``, the latest offence first."""
        current = [culprit for culprit in self._culprits.values() if now_ns - culprit.last_ns <= self._hold_ns]
        return tuple(sorted(current, key=lambda culprit: -culprit.last_ns))

    def shift(self, offset_ns: int) -> None:
        """The clock has jumped by ``offset_ns``: keep the ages of all blames."""
        self._culprits = {
            key: Culprit(known.sensor, known.fault, known.since_ns + offset_ns, known.last_ns + offset_ns)
            for key, known in self._culprits.items()
        }
