"""Asking theorems about models."""

from robust_core.analysis.attraction import certified_region, maximised_region
from robust_core.analysis.decay import largest_decay
from robust_core.analysis.decide import Result, decide
from robust_core.analysis.maps import decide_many
from robust_core.analysis.sweep import SweepResult, sweep

__all__ = [
    "Result",
    "SweepResult",
    "certified_region",
    "decide",
    "decide_many",
    "largest_decay",
    "maximised_region",
    "sweep",
]
