"""The one error of the set-up: a sentence for the user."""

from __future__ import annotations


class SetupProblem(Exception):
    """What is wrong and the command that mends it, in one sentence."""
