"""State-feedback designs whose gains are proven after they are rounded."""

from robust_core.stabilisation.closed_loop import ClosedLoop
from robust_core.stabilisation.dependent import design_dependent
from robust_core.stabilisation.design import Design
from robust_core.stabilisation.quadratic import design_quadratic
from robust_core.stabilisation.refutation import refute_printed
from robust_core.stabilisation.request import Request
from robust_core.stabilisation.theorem_2_4 import PrintedStabilisation

__all__ = [
    "ClosedLoop",
    "Design",
    "PrintedStabilisation",
    "Request",
    "design_dependent",
    "design_quadratic",
    "refute_printed",
]
