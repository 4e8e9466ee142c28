"""Polytopic models: vertices, groups of weights, bounds on the rates of the weights."""

from robust_core.models.filter_plant import FilterPlant
from robust_core.models.polytope import PolytopicSystem
from robust_core.models.rates import RateBounds
from robust_core.models.simplices import Simplices

__all__ = ["FilterPlant", "PolytopicSystem", "RateBounds", "Simplices"]
