"""What the figures of the recordings are to reach."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Target:
    """label: what the figure is. limit: the largest value that is good enough."""

    label: str
    limit: float
    unit: str


TARGETS = {
    "recordings.slip.slip_law.rms_m": Target("RMS end error, slip law", 0.23, "m"),
    "recordings.slip.slip_law_fitted.rms_m": Target("RMS end error, slip law fitted", 0.205, "m"),
    "recordings.outdoor.filter.mean_m": Target("mean distance to GPS, filter", 8.8, "m"),
    "recordings.outdoor.longest_deaf_s": Target("longest refusal of a good sensor", 1.0, "s"),
}
"""By the key of the metric."""
