"""Which of several bands is driven: the one that is followed, unless another is clearly better or it may not be."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_navigation.band.band_check import BandCheck, Finding
from tracked_navigation.band.band_result import BAND, OTHER_SIDE, SLOWER, STOP, Candidate
from tracked_navigation.band.initial_bands import USUAL_STEP_S, Guess
from tracked_navigation.band.interval_cost import TIME_S
from tracked_navigation.band.optimizer import BandEnd, BandOptimizer
from tracked_navigation.band.rollout import rolled_out
from tracked_navigation.band.route import Route
from tracked_navigation.band.settings import BandSettings
from tracked_navigation.band.surroundings import Surroundings
from tracked_types import wrap_angle

Array = NDArray[np.float64]
FOLLOWED = "as before"
_SCREENING, _REFINING = 6, 16  # iterations, to see what a band is worth and to pull it tight
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


class BandContest:
    """Optimises bands, judges them, and chooses."""

    def __init__(self, settings: BandSettings, optimizer: BandOptimizer, check: BandCheck) -> None:
        self.settings, self.optimizer, self.check = settings, optimizer, check
        self._turn = 0

    def decide(self, followed: Array | None, others: list[Guess], route: Route, surroundings: Surroundings) -> Outcome:
        """``followed``: the band of the last update, if any. One of the others challenges it at each update, in turn."""
        contest = _Contest(self, route, surroundings)
        if followed is None:
            return contest.anew(others)
        self._turn += 1
        return contest.against_followed(followed, others, others[self._turn % len(others)])


class _Contest:
    """One decision."""

    def __init__(self, owner: BandContest, route: Route, surroundings: Surroundings) -> None:
        self.settings, self.optimizer, self.check = owner.settings, owner.optimizer, owner.check
        self.route, self.surroundings = route, surroundings
        self.end = BandEnd.at_rest(route.end) if route.rests else BandEnd.passing(route.end)
        self.tried: list[Tried] = []

    def against_followed(self, followed: Array, others: list[Guess], challenger: Guess) -> Outcome:
        """Keep to the band that is followed unless the challenger is better by the switching gain."""
        kept = self._try(FOLLOWED, followed, _REFINING)
        to_beat = (1.0 - self.settings.switch_gain) * kept.cost
        rival = self._screened(challenger, to_beat)
        if rival is not None and not rival.finding.reason and (rival.cost < to_beat or kept.finding.reason):
            if kept.finding.reason:
                return self._outcome(rival, OTHER_SIDE, f"as before it would be {kept.finding.reason}")
            return self._outcome(rival, BAND, "")
        if not kept.finding.reason:
            return self._outcome(kept, BAND, "")
        return self._otherwise(kept, [guess for guess in others if guess is not challenger])

    def anew(self, others: list[Guess]) -> Outcome:
        """The cheapest that may be driven."""
        screened = sorted(
            (self._optimised(guess.nodes, _SCREENING) + (guess.name,) for guess in others), key=lambda each: each[1]
        )
        first: Tried | None = None
        for nodes, _, name in screened:
            tried = self._try(name, nodes, _REFINING)
            if not tried.finding.reason:
                reason = f"the cheapest way would be {first.finding.reason}" if first else ""
                return self._outcome(tried, BAND, reason)
            first = first or tried
        assert first is not None
        return self._otherwise(first, [])

    def _otherwise(self, refused: Tried, others: list[Guess]) -> Outcome:
        """Slower, by another way, or not at all."""
        reason = f"at full speed it would be {refused.finding.reason}"
        self.optimizer.set_speed_limit(_SLOWER_SHARE * self.settings.cruise_mps)
        slower = self._try(f"{refused.way}, slower", _stretched(refused.nodes), _REFINING)
        self.optimizer.set_speed_limit(self.settings.cruise_mps)
        if not slower.finding.reason:
            return self._outcome(slower, SLOWER, reason)
        for guess in others:
            tried = self._try(guess.name, guess.nodes, _SCREENING + _REFINING)
            if not tried.finding.reason:
                return self._outcome(tried, OTHER_SIDE, reason)
        return self._outcome(None, STOP, refused.finding.reason)

    def _screened(self, guess: Guess, to_beat: float) -> Tried | None:
        nodes, cost = self._optimised(guess.nodes, _SCREENING)
        return self._try(guess.name, nodes, _REFINING) if cost < _HOPEFUL * to_beat else None

    def _try(self, way: str, nodes: Array, iterations: int) -> Tried:
        nodes, cost = self._optimised(nodes, iterations)
        samples = rolled_out(nodes, self.settings.limits, rests=self.route.rests)
        finding = self.check.judge(*samples, self.surroundings)
        if not finding.reason and self.route.rests:
            finding = Finding(self._miss(samples[1][-1]), finding.clearance_m, finding.contact_s)
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
        footprint = self.settings.footprint
        found = self.optimizer.optimise(
            nodes, self.end, lambda poses: self.surroundings.associate(poses, footprint), iterations
        )
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
