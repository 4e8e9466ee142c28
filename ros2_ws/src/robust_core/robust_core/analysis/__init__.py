"""Asking theorems about models."""

from robust_core.analysis.decide import Result, decide

__all__ = ["Result", "decide"]
