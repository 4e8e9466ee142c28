"""Timed elastic band: the way past obstacles and movers that takes least time, checked before it is handed out."""

from tracked_navigation.band.band_result import BandResult, Candidate
from tracked_navigation.band.settings import BandSettings
from tracked_navigation.band.timed_elastic_band import TimedElasticBand

__all__ = ["BandResult", "BandSettings", "Candidate", "TimedElasticBand"]
