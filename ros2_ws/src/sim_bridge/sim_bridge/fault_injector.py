"""Injection of faults between a sensor and its listeners."""

from collections import deque
from typing import Generic, TypeVar

from numpy.random import Generator

from sim_bridge.corruption import Corruption, Disturbance
from sim_bridge.faults import Fault
from tracked_types import to_nanoseconds

Sample = TypeVar("Sample")


class FaultySensor(Generic[Sample]):
    """Stream of one sensor with its faults: at most one sample in, any number of samples out."""

    def __init__(self, corruption: Corruption[Sample], random: Generator) -> None:
        self._corruption = corruption
        self._random = random
        self._faults: list[Fault] = []
        self._late: deque[tuple[int, Sample]] = deque()

    def inject(self, fault: Fault) -> None:
        """Add a fault; several may act at once."""
        self._faults.append(fault)

    def end_faults(self) -> None:
        """End every fault, present and future; samples that are under way late still arrive."""
        self._faults.clear()

    def active(self, now_ns: int) -> tuple[Fault, ...]:
        """Faults that act now."""
        return tuple(fault for fault in self._faults if fault.active(now_ns))

    def update(self, sample: Sample | None, now_ns: int) -> list[Sample]:
        """Samples that listeners get at ``now_ns``, given what the sensor measured (None: nothing)."""
        delivered = [] if sample is None else self._deliver(sample, now_ns)
        if not self._late:
            return delivered
        arrived = [late for due_ns, late in self._late if due_ns <= now_ns]
        self._late = deque(entry for entry in self._late if entry[0] > now_ns)
        return arrived + delivered

    def _deliver(self, sample: Sample, now_ns: int) -> list[Sample]:
        faults = self.active(now_ns)
        sample = self._corruption.apply(sample, self._disturbance(faults))
        # Every dropout draws, whatever the others decide: a second fault must not shift the first one's luck.
        lost = [float(self._random.random()) < fault.magnitude for fault in faults if fault.kind == "dropout"]
        if any(lost) or any(fault.kind == "blackout" for fault in faults):
            return []
        delay_s = sum(fault.magnitude for fault in faults if fault.kind == "delay")
        if delay_s > 0.0:
            self._late.append((now_ns + to_nanoseconds(delay_s), sample))
            return []
        return [sample]

    def _disturbance(self, faults: tuple[Fault, ...]) -> Disturbance:
        signs = (-1.0, 1.0)
        return Disturbance(
            frozen=any(fault.kind == "freeze" for fault in faults),
            bias=sum(fault.magnitude for fault in faults if fault.kind == "bias"),
            jump=sum(float(self._random.choice(signs)) * fault.magnitude for fault in faults if fault.kind == "jump"),
            not_a_number=any(fault.kind == "nan" for fault in faults),
        )
