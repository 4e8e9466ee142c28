"""Robust filters: analysis, synthesis and finite-frequency synthesis under the extended dissipative index."""

from robust_core.filtering.analyse import FilterAnalysis, analyse_filter
from robust_core.filtering.band import band_gain, error_gain, limit_of_filters
from robust_core.filtering.design import FilterDesign, design_filter
from robust_core.filtering.filter import Filter, error_poles_model
from robust_core.filtering.finite_design import FiniteFrequencyDesign, certify_band, design_finite_frequency
from robust_core.filtering.finite_frequency import FiniteFrequencyFilter
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
    "FiniteFrequencyDesign",
    "FiniteFrequencyFilter",
    "ImpossibleIndexError",
    "analyse_filter",
    "band_gain",
    "certify_band",
    "design_filter",
    "design_finite_frequency",
    "dissipative",
    "energy_to_peak",
    "error_gain",
    "error_poles_model",
    "h_infinity",
    "limit_of_filters",
    "passive",
    "very_strictly_passive",
]
