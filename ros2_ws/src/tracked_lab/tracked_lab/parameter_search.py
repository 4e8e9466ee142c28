"""Search for positive numbers that score best: anywhere first, then around the best, within a budget of trials."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

Point = Mapping[str, float]
Ranges = Mapping[str, tuple[float, float]]


@dataclass(slots=True)
class Proposal:
    """Numbers to try, by name; whoever tries them enters the score, the lower the better."""

    point: Point
    score: float = float("inf")


def proposals(start: Point, ranges: Ranges, budget: int, generator: Generator) -> Iterator[Proposal]:
    """As many proposals as the budget; tell each its score before asking for the next.

    The first is ``start``, a third is drawn anywhere in the ranges, evenly in the logarithm, the rest around the best.
    """
    best = Proposal(dict(start))
    yield best
    for number in range(1, budget):
        if number <= budget // 3:
            drawn = {name: float(np.exp(generator.uniform(*np.log(ends)))) for name, ends in ranges.items()}
        else:
            drawn = _near(best.point, ranges, 0.7 * (1.0 - 0.7 * number / budget), generator)
        proposal = Proposal({name: float(f"{value:.3g}") for name, value in drawn.items()})
        yield proposal
        if proposal.score < best.score:
            best = proposal


def _near(point: Point, ranges: Ranges, reach: float, generator: Generator) -> dict[str, float]:
    moved = {}
    for name, (low, high) in ranges.items():
        factor = float(np.exp(reach * generator.standard_normal())) if generator.random() < 0.7 else 1.0
        moved[name] = min(max(point[name] * factor, low), high)
    return moved
