"""Optimal control problem of both layers and the solvers for it. Knows no ROS and no robot."""

from casadi_code import SolverCodeWarning
from nmpc_layers.solver.box_solver import BoxSolver
from nmpc_layers.solver.motion_model import Motion, MotionParameters
from nmpc_layers.solver.problem import Problem
from nmpc_layers.solver.solution import Outcome, Solution
from nmpc_layers.solver.terminal_weight import TerminalWeight
from nmpc_layers.solver.track_solver import TrackLimits, TrackSolver
from nmpc_layers.solver.weights import Weights

__all__ = [
    "BoxSolver",
    "Motion",
    "MotionParameters",
    "Outcome",
    "Problem",
    "Solution",
    "SolverCodeWarning",
    "TerminalWeight",
    "TrackLimits",
    "TrackSolver",
    "Weights",
]
