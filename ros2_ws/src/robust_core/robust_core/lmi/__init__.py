"""Linear matrix inequalities: unknowns, constraints, and their solution by an interior-point method.

A theorem writes its inequalities once, as plain array formulas. The same formulas, evaluated on the unit vectors of the
unknowns, give the coefficients for the solver; on a solution, its eigenvalues; on exact numbers, a proof.
"""

from robust_core.lmi.constraint import Constraint, he
from robust_core.lmi.unknowns import Unknown, Unknowns

__all__ = ["Constraint", "Unknown", "Unknowns", "he"]
