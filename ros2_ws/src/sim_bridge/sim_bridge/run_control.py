"""The run of a simulation: when it goes on, pause, step, reset, faults."""

from collections.abc import Callable

from sim_bridge.faults import Fault, FaultRefused, kind_called, sensor_called
from sim_bridge.pacing import Pacer
from sim_bridge.sensor_suite import SensorBatch
from sim_bridge.simulator import Simulator
from tracked_types import to_nanoseconds

MOST_STEPS_S = 10.0
"""Simulated time that one request to step may take; nothing else is served meanwhile."""

_PAUSED_WAIT_S = 1.0


class WrongStateError(ValueError):
    """The request does not fit the present state, such as stepping while time runs."""


class RunControl:
    """Advances a simulator tick by tick at the pacer's pace, unless paused.

    deliver: gets what the sensors deliver at each tick.
    """

    def __init__(self, simulator: Simulator, pacer: Pacer, deliver: Callable[[SensorBatch], None]) -> None:
        self._simulator = simulator
        self._pacer = pacer
        self._deliver = deliver
        self._paused = False

    @property
    def paused(self) -> bool:
        """Whether time stands still until it is set to run on, or stepped."""
        return self._paused

    @property
    def stamp_ns(self) -> int:
        """Simulated time."""
        return self._simulator.stamp_ns

    def work(self, wall_s: float) -> float:
        """Run one tick if it is due at ``wall_s`` of a steady clock; seconds until the next call is worth while.

        Raises
        ------
        LockStalled, PhysicsDivergedError: the run is over.
        """
        if self._paused:
            return _PAUSED_WAIT_S
        simulator = self._simulator
        newest_command_ns = simulator.intake.newest_stamp_ns
        wait_s = self._pacer.wait_s(simulator.stamp_ns, simulator.next_tick_ns, newest_command_ns, wall_s)
        if wait_s == 0.0:
            self._deliver(simulator.advance())
        return wait_s

    def set_paused(self, paused: bool) -> None:
        """Stop time, or let it run on."""
        self._paused = paused
        self._pacer.restart()

    def step(self, steps: int) -> None:
        """Run that many steps of the physics while paused.

        Raises
        ------
        WrongStateError: if time runs.
        ValueError: if it is more than MOST_STEPS_S of simulated time.
        """
        if not self._paused:
            raise WrongStateError("time runs: pause before stepping")
        most = round(MOST_STEPS_S / self._simulator.step_s)
        if not 0 <= steps <= most:
            raise ValueError(f"steps must lie in 0 to {most}, got {steps}")
        for _ in range(steps):
            batch = self._simulator.step()
            if batch is not None:
                self._deliver(batch)

    def reset(self, seed: int) -> None:
        """Start anew with the noise of ``seed``; time goes on (or stays paused), lock-step awaits a first command."""
        self._simulator.reset(seed)
        self._pacer.restart()

    def inject_fault(self, sensor: str, kind: str, duration_s: float, magnitude: float, start_ns: int = 0) -> None:
        """Disturb a sensor from ``start_ns`` on, at the earliest now, for ``duration_s`` or, with 0, until ended.

        Raises
        ------
        FaultRefused: naming the argument and what was expected.
        """
        if not 0.0 <= duration_s < 1e9:
            raise FaultRefused(f"duration must be 0 (until ended) or positive seconds, got {duration_s!r}")
        start_ns = max(start_ns, self._simulator.stamp_ns)
        end_ns = start_ns + to_nanoseconds(duration_s) if duration_s else None
        self._simulator.inject(Fault(sensor_called(sensor), kind_called(kind), start_ns, end_ns, magnitude))

    def end_faults(self, sensor: str) -> None:
        """End the faults of a sensor; raises FaultRefused if there is no such sensor."""
        self._simulator.end_faults(sensor_called(sensor))
