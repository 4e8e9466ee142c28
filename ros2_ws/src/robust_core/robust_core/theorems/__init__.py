"""Theorems on polytopic systems, one per file: data in, inequalities out. Nothing here imports a solver."""

from robust_core.theorems.base import Theorem, theorem_from_json
from robust_core.theorems.common import CommonLyapunov
from robust_core.theorems.d_stability import DStability
from robust_core.theorems.dependent import ParameterDependent
from robust_core.theorems.relaxed import Relaxed
from robust_core.theorems.slack import Slack
from robust_core.theorems.tensor import TensorCorners, TensorProduct

__all__ = [
    "CommonLyapunov",
    "DStability",
    "ParameterDependent",
    "Relaxed",
    "Slack",
    "TensorCorners",
    "TensorProduct",
    "Theorem",
    "theorem_from_json",
]
