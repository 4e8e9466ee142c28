"""Polytopic models derived from formulas (CasADi): weights, vertices, bounds on rates, and checks against the original.

Needs CasADi; enclosures also need python-flint.
"""

from robust_core.symbolic.agreement import Agreement, check_agreement
from robust_core.symbolic.sectors import Term, derive
from robust_core.symbolic.system import StateDependentModel

__all__ = ["Agreement", "StateDependentModel", "Term", "check_agreement", "derive"]
