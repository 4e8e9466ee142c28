"""Terminal weights and sets of predictive controllers, with proofs that the cost descends."""

from robust_core.terminal.design import TerminalDesign, design_terminal
from robust_core.terminal.loading import ProvenTerminal, load_tracking_terminal
from robust_core.terminal.theorem import TerminalIngredient
from robust_core.terminal.tracking import CommandLimits, design_tracking_terminal

__all__ = [
    "CommandLimits",
    "ProvenTerminal",
    "TerminalDesign",
    "TerminalIngredient",
    "design_terminal",
    "design_tracking_terminal",
    "load_tracking_terminal",
]
