"""Robust filters: analysis, synthesis and finite-frequency synthesis under the extended dissipative index."""

from robust_core.filtering.analyse import FilterAnalysis, analyse_filter
from robust_core.filtering.design import FilterDesign, design_filter
from robust_core.filtering.filter import Filter, error_poles_model
from robust_core.filtering.index import (
    DissipativeIndex,
    ImpossibleIndexError,
    dissipative,
    energy_to_peak,
    h_infinity,
    passive,
    very_strictly_passive,
)
from robust_core.filtering.theorem_3_1 import DissipativeFilter

__all__ = [
    "DissipativeFilter",
    "DissipativeIndex",
    "Filter",
    "FilterAnalysis",
    "FilterDesign",
    "ImpossibleIndexError",
    "analyse_filter",
    "design_filter",
    "dissipative",
    "energy_to_peak",
    "error_poles_model",
    "h_infinity",
    "passive",
    "very_strictly_passive",
]
