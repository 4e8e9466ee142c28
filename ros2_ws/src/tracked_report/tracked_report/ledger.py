"""The ledger of claims: what is claimed, in which direction, and what measures it."""

import math
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, model_validator

from tracked_types.checked_yaml import CheckedFileError, CheckedModel, load_checked_yaml

Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$")]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Text = Annotated[str, Field(min_length=1)]
Direction = Literal["at_most", "at_least", "within", "equal"]

SELF = "self"
"""Measurement that is the claims run itself; it offers ``claims.seconds``."""


class Measurement(CheckedModel):
    """A command and the metrics file it writes.

    quick: the short form of the command for ``--quick``. It runs with TRACKED_OUT=out/quick, so that its
    figures never overwrite the full ones.
    """

    run: Text
    metrics: Annotated[str, Field(pattern=r"^out/.+\.json$")]
    quick: str | None = None
    timeout_s: Annotated[float, Field(gt=0.0, le=7200.0)] = 1800.0


class Claim(CheckedModel):
    """One claim. ``from`` names the measurement, ``key`` the figure in its metrics file."""

    id: Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*\.[a-z0-9_]+$")]
    statement: Text
    direction: Direction
    target: Finite | tuple[Finite, Finite]
    unit: str
    source: Annotated[str, Field(alias="from")]
    key: Text
    quick: bool = False
    note: str = ""

    @model_validator(mode="after")
    def _target_fits(self) -> "Claim":
        if (self.direction == "within") != isinstance(self.target, tuple):
            raise ValueError(f"target of {self.id}: 'within' takes [low, high], the other directions one number")
        if isinstance(self.target, tuple) and self.target[0] > self.target[1]:
            raise ValueError(f"target of {self.id}: low must not exceed high, got {list(self.target)}")
        return self

    def holds(self, value: float) -> bool:
        """Whether a measured value is as good as claimed; a value that is not finite never is."""
        return self.margin(value) >= 0.0

    def margin(self, value: float) -> float:
        """Distance to the nearest bound in the claim's unit, negative beyond it; -inf for a value that is not finite.

        For ``equal`` minus the distance, which is zero to within 1e-9 relative.
        """
        if not math.isfinite(value):
            return -math.inf
        if isinstance(self.target, tuple):
            return min(value - self.target[0], self.target[1] - value)
        if self.direction == "at_most":
            return self.target - value
        if self.direction == "at_least":
            return value - self.target
        return 0.0 if math.isclose(value, self.target, rel_tol=1e-9, abs_tol=1e-12) else -abs(value - self.target)

    def target_text(self) -> str:
        """The target with its direction, for a table."""
        if isinstance(self.target, tuple):
            return f"{self.target[0]:g} ... {self.target[1]:g}"
        return f"{ {'at_most': '<=', 'at_least': '>=', 'equal': '='}[self.direction] } {self.target:g}"


class Ledger(CheckedModel):
    """Claims of one part and the measurements behind them."""

    part: Name
    description: str = ""
    measurements: dict[Name, Measurement]
    claims: tuple[Claim, ...]

    @model_validator(mode="after")
    def _consistent(self) -> "Ledger":
        seen: set[str] = set()
        for claim in self.claims:
            if claim.id in seen:
                raise ValueError(f"claims: id {claim.id} appears twice")
            seen.add(claim.id)
            if not claim.id.startswith(f"{self.part}."):
                raise ValueError(f"claims: id {claim.id} must start with {self.part}.")
            if claim.source == SELF:
                continue
            if claim.source not in self.measurements:
                known = ", ".join(self.measurements)
                raise ValueError(f"claims: {claim.id} is from {claim.source!r}; there are {known}")
            if claim.quick and self.measurements[claim.source].quick is None:
                raise ValueError(f"claims: {claim.id} is quick, but {claim.source} has no quick command")
        return self


def load_ledgers(folder: Path, part: str | None = None) -> tuple[Ledger, ...]:
    """Every ledger of a folder in order of names, or only the one of ``part``.

    Raises
    ------
    CheckedFileError: if there is none, or one has a missing, unknown or inconsistent key.
    """
    ledgers = tuple(load_checked_yaml(Ledger, path) for path in sorted(folder.glob("*.yaml")))
    chosen = tuple(ledger for ledger in ledgers if part is None or ledger.part == part)
    if not chosen:
        known = ", ".join(ledger.part for ledger in ledgers) or "none"
        raise CheckedFileError(f"{folder}: no ledger{f' of part {part!r}' if part else ''}; parts there: {known}")
    return chosen
