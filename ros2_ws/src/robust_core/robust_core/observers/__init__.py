"""Observers that detect faults, and proofs of what they detect."""

from robust_core.observers.design import ObserverDesign, admissible_pole, design_observer
from robust_core.observers.observer import BlindObserverError, FaultObserver
from robust_core.observers.supremum import largest_tau, supremum_tau
from robust_core.observers.theorem_4_1 import LipschitzObserver

__all__ = [
    "BlindObserverError",
    "FaultObserver",
    "LipschitzObserver",
    "ObserverDesign",
    "admissible_pole",
    "design_observer",
    "largest_tau",
    "supremum_tau",
]
