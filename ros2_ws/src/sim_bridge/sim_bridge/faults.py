"""Faults that can be injected into a sensor's stream."""

import math
from dataclasses import dataclass
from typing import Literal, get_args

Sensor = Literal["tracks", "imu", "scan"]
Kind = Literal["freeze", "bias", "blackout", "dropout", "delay", "nan", "jump"]
SENSORS: tuple[Sensor, ...] = get_args(Sensor)
KINDS: tuple[Kind, ...] = get_args(Kind)

LONGEST_DELAY_S = 10.0


class FaultRefused(ValueError):
    """A fault makes no sense; the text names what was expected."""


@dataclass(frozen=True, slots=True)
class Fault:
    """One fault of one sensor, from ``start_ns`` until ``end_ns`` of simulated time.

    kind: ``freeze`` repeats the last value under new stamps; ``bias`` adds ``magnitude``; ``jump`` adds it
    with a random sign, drawn anew for each sample; ``nan`` replaces every number; ``blackout`` sends
    nothing; ``dropout`` loses that share of the samples; ``delay`` delivers late, with the true stamp.
    magnitude: of a bias rad/s about z (imu), m/s (tracks) or m (scan); of a jump rad/s about z (imu) or m
    (tracks, scan); of a dropout the share, 0 to 1; of a delay s.

    Raises
    ------
    FaultRefused: naming the field and what was expected.
    """

    sensor: Sensor
    kind: Kind
    start_ns: int = 0
    end_ns: int | None = None
    magnitude: float = 0.0

    def __post_init__(self) -> None:
        sensor_called(self.sensor)
        kind_called(self.kind)
        if not math.isfinite(self.magnitude):
            raise FaultRefused(f"magnitude must be finite, got {self.magnitude!r}")
        if self.kind == "dropout" and not 0.0 <= self.magnitude <= 1.0:
            raise FaultRefused(f"magnitude of a dropout is the share lost, 0 to 1; got {self.magnitude!r}")
        if self.kind == "delay" and not 0.0 <= self.magnitude <= LONGEST_DELAY_S:
            raise FaultRefused(f"magnitude of a delay lies in 0 to {LONGEST_DELAY_S:g} s; got {self.magnitude!r}")
        if self.end_ns is not None and self.end_ns < self.start_ns:
            raise FaultRefused(f"a fault cannot end ({self.end_ns}) before it starts ({self.start_ns})")

    def active(self, stamp_ns: int) -> bool:
        """Whether a sample with this stamp is affected."""
        return self.start_ns <= stamp_ns and (self.end_ns is None or stamp_ns < self.end_ns)


def sensor_called(name: str) -> Sensor:
    """The sensor of this name; raises FaultRefused, with the names that there are."""
    for sensor in SENSORS:
        if sensor == name:
            return sensor
    raise FaultRefused(f"sensor must be one of {', '.join(SENSORS)}; got {name!r}")


def kind_called(name: str) -> Kind:
    """The kind of fault of this name; raises FaultRefused, with the names that there are."""
    for kind in KINDS:
        if kind == name:
            return kind
    raise FaultRefused(f"kind must be one of {', '.join(KINDS)}; got {name!r}")
