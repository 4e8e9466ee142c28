"""Which of several bands is driven: the one that is followed, unless another is clearly better or it may not be."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_navigation.band.band_check import BandCheck, Finding
from tracked_navigation.band.band_result import BAND, OTHER_SIDE, SLOWER, STOP, Candidate
from tracked_navigation.band.braking import followed_by_stop
from tracked_navigation.band.initial_bands import USUAL_STEP_S, Way, band_along, ways_along
from tracked_navigation.band.interval_cost import TIME_S
from tracked_navigation.band.optimizer import BandEnd, BandOptimizer
from tracked_navigation.band.rollout import rolled_out
from tracked_navigation.band.route import Route
from tracked_navigation.band.settings import BandSettings
from tracked_navigation.band.surroundings import Surroundings
from tracked_types import Pose2, Twist2, wrap_angle

Array = NDArray[np.float64]
FOLLOWED = "as before"
_SCREENING, _REFINING = 5, 12  # iterations, to see what a band is worth and to pull it tight
_MOST_ITERATIONS = 30  # of one update; what has not been tried by then has its turn at the next
_BRAKING_POINTS = (0.75, 0.4, 0.15)  # share of the time until a band must not be followed any more
_LEAST_DRIVE_S = 0.1
_SLOWER_SHARE = 0.5
_HOPEFUL = 1.5  # a screened band is refined if it costs no more than this times what it has to beat


@dataclass(frozen=True, slots=True)
class Tried:
    """A band after optimising: nodes (n + 1, 6), what is handed out of it (times, states, inputs), and the verdict."""

    way: str
    nodes: Array
    cost: float
    samples: tuple[Array, Array, Array]
    finding: Finding

    @property
    def summary(self) -> Candidate:
        """For the result."""
        return Candidate(self.way, self.cost, self.finding.reason)


@dataclass(frozen=True, slots=True)
class Outcome:
    """chosen: None if nothing may be driven. reason: in words, empty if all is as planned."""

    chosen: Tried | None
    kind: str
    reason: str
    candidates: tuple[Candidate, ...]


@dataclass(frozen=True, slots=True)
class Task:
    """From where, along what, past what."""

    start: Pose2
    twist: Twist2
    route: Route
    surroundings: Surroundings


class BandContest:
    """Optimises bands, judges them, and chooses."""

    def __init__(self, settings: BandSettings, optimizer: BandOptimizer, check: BandCheck) -> None:
        self.settings, self.optimizer, self.check = settings, optimizer, check
        self._updates = 0

    def decide(self, task: Task, followed: Array | None) -> Outcome:
        """``followed``: the band of the last update, if any. At every other update it is challenged by a band along
        another way, each in turn."""
        contest = _Contest(self, task)
        if followed is None:
            return contest.anew()
        self._updates += 1
        return contest.against_followed(followed, self._updates // 2 if self._updates % 2 else None)


class _Contest:
    """One decision."""

    def __init__(self, owner: BandContest, task: Task) -> None:
        self.settings, self.optimizer, self.check = owner.settings, owner.optimizer, owner.check
        self.task, self.route = task, task.route
        self.end = BandEnd.at_rest(task.route.end) if task.route.rests else BandEnd.passing(task.route.end)
        self.tried: list[Tried] = []
        self._iterations_left = _MOST_ITERATIONS

    def against_followed(self, followed: Array, turn: int | None) -> Outcome:
        """Keep to the band that is followed unless another one is better by the switching gain, or it may not be
        driven; ``turn`` says which of the others is tried, None for none of them."""
        kept = self._try(FOLLOWED, followed, _REFINING)
        if not kept.finding.reason and turn is None:
            return self._outcome(kept, BAND, "")
        ways = ways_along(self.route, self.task.surroundings, self.settings)
        ways = [ways[(index + (turn or 0)) % len(ways)] for index in range(len(ways))]
        if kept.finding.reason:
            return self._otherwise(kept, ways)
        to_beat = (1.0 - self.settings.switch_gain) * kept.cost
        nodes, cost = self._optimised(self._begun(ways[0]), _SCREENING)
        if cost < _HOPEFUL * to_beat:
            rival = self._try(ways[0].name, nodes, _REFINING)
            if not rival.finding.reason and rival.cost < to_beat:
                return self._outcome(rival, BAND, "")
        return self._outcome(kept, BAND, "")

    def anew(self) -> Outcome:
        """The cheapest that may be driven."""
        ways = ways_along(self.route, self.task.surroundings, self.settings)
        screened = [(*self._optimised(self._begun(way), _SCREENING), way.name) for way in ways]
        screened.sort(key=lambda each: each[1])
        for nodes, _, name in screened:
            if self.tried and self._iterations_left <= 0:
                break
            tried = self._try(name, nodes, _REFINING)
            if not tried.finding.reason:
                first = self.tried[0].finding.reason
                return self._outcome(tried, BAND, f"the cheapest way would be {first}" if first else "")
        return self._otherwise(self.tried[0], [])

    def _otherwise(self, refused: Tried, ways: list[Way]) -> Outcome:
        """Slower, by another way, or up to a stop in time."""
        reason = f"at full speed it would be {refused.finding.reason}"
        self.optimizer.set_speed_limit(_SLOWER_SHARE * self.settings.cruise_mps)
        slower = self._try(f"{refused.way}, slower", _stretched(refused.nodes), _REFINING)
        self.optimizer.set_speed_limit(self.settings.cruise_mps)
        if not slower.finding.reason:
            return self._outcome(slower, SLOWER, reason)
        for way in ways:
            if self._iterations_left <= 0:
                break
            tried = self._try(way.name, self._begun(way), _SCREENING + _REFINING)
            if not tried.finding.reason:
                return self._outcome(tried, OTHER_SIDE, reason)
        cheapest = min(self.tried, key=lambda each: each.cost)
        stopping = self._stopping_in_time(cheapest)
        if stopping is not None:
            return self._outcome(stopping, STOP, f"{cheapest.finding.reason}; brakes before")
        return self._outcome(None, STOP, refused.finding.reason)

    def _stopping_in_time(self, tried: Tried) -> Tried | None:
        """Along a band that may not be driven to its end, and to rest before that; None if it is too late."""
        for share in _BRAKING_POINTS:
            begin_s = share * tried.finding.begins_s
            if begin_s < _LEAST_DRIVE_S:
                return None
            samples = followed_by_stop(tried.samples, begin_s, self.settings.limits)
            finding = self.check.judge(*samples, self.task.surroundings)
            if not finding.reason:
                return Tried(tried.way, tried.nodes, tried.cost, samples, finding)
        return None

    def _begun(self, way: Way) -> Array:
        return band_along(way, self.route, self.task.start, self.task.twist, self.settings)

    def _try(self, way: str, nodes: Array, iterations: int) -> Tried:
        nodes, cost = self._optimised(nodes, iterations)
        samples = rolled_out(nodes, self.settings.limits, rests=self.route.rests)
        finding = self.check.judge(*samples, self.task.surroundings)
        if not finding.reason and self.route.rests:
            finding = Finding(self._miss(samples[1][-1]), finding.clearance_m, finding.begins_s, finding.contact_s)
        self.tried.append(Tried(way, nodes, cost, samples, finding))
        return self.tried[-1]

    def _miss(self, state: Array) -> str:
        """By how much a band that should end at rest misses its end, in words; empty if it does not."""
        away = float(np.hypot(*(state[:2] - self.route.end[:2])))
        turn = abs(wrap_angle(float(state[2] - self.route.end[2])))
        if away <= self.settings.goal_tolerance_m and turn <= self.settings.goal_tolerance_rad:
            return ""
        return f"{away:.3f} m and {turn:.3f} rad off its end"

    def _optimised(self, nodes: Array, iterations: int) -> tuple[Array, float]:
        """Nodes and cost; the latter with a price of time that does not depend on the number of poses."""
        surroundings, footprint = self.task.surroundings.around(nodes), self.settings.footprint
        found = self.optimizer.optimise(
            nodes,
            self.end,
            lambda poses: surroundings.associate(poses, footprint),
            min(iterations, self._iterations_left),
        )
        self._iterations_left -= found.iterations
        steps = np.diff(found.nodes[:, 5])
        time_cost = float(steps @ steps) / TIME_S**2
        return found.nodes, found.cost - time_cost + USUAL_STEP_S / TIME_S**2 * float(found.nodes[-1, 5])

    def _outcome(self, chosen: Tried | None, kind: str, reason: str) -> Outcome:
        return Outcome(chosen, kind, reason, tuple(tried.summary for tried in self.tried))


def _stretched(nodes: Array) -> Array:
    """The same poses in longer time, from the same start."""
    slow = nodes.copy()
    slow[1:, 3:5] *= _SLOWER_SHARE
    slow[:, 5] /= _SLOWER_SHARE
    return slow
