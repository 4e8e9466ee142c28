"""The shape of every theorem."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from functools import lru_cache
from importlib import import_module
from typing import Any, ClassVar, Protocol, Self

import numpy as np

from robust_core.errors import ArgumentError, CertificateMismatchError
from robust_core.lmi import Constraint, Unknowns
from robust_core.lmi.unknowns import Values
from robust_core.rational import rational, to_float

Data = Mapping[str, Any]


class Model(Protocol):
    """What a theorem needs of a model, whatever its kind."""

    @property
    def digest(self) -> str:
        """Hash of everything it says."""

    @property
    def rates_proven(self) -> bool:
        """Whether its bounds on rates are beyond doubt."""

    def data(self, *, exact: bool = False, bound: str = "high") -> Data:
        """Arrays for formulas, floats or exact, with rates at one end of their enclosures."""

    def to_json(self) -> dict[str, Any]:
        """Plain data, with a ``kind`` under which it was registered."""


@dataclass(frozen=True)
class Theorem(ABC):
    """Inequalities that, where they have a solution, prove something about a model.

    Subclasses are frozen dataclasses whose fields are the theorem's options (numbers, texts, tuples of them).
    """

    NAME: ClassVar[str]
    PROVES: ClassVar[str]
    USES_RATES: ClassVar[bool] = False
    AFFINE: ClassVar[tuple[str, ...]] = ()
    """Data in which the inequalities are jointly affine, all that differs between models; () makes no such promise."""
    REGISTRY: ClassVar[dict[str, "type[Theorem]"]] = {}

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        if "NAME" in cls.__dict__:
            Theorem.REGISTRY[cls.NAME] = cls

    def specialised(self, model: Any) -> Self:
        """The theorem with options filled that the model decides; raises where the model cannot be asked."""
        return self

    @abstractmethod
    def unknowns(self, model: Any) -> Unknowns:
        """The matrices to be found."""

    @abstractmethod
    def constraints(self, data: Data, values: Values) -> Sequence[Constraint]:
        """The inequalities. Only +, -, *, @ and indexing, with leading axes broadcast, on floats and exact numbers."""

    def data(self, model: Any, *, exact: bool = False, bound: str = "high") -> Data:
        """The model's arrays, and one half, in one kind of numbers."""
        half = rational(0.5) if exact else 0.5
        return {**model.data(exact=exact, bound=bound), "half": half}

    def to_json(self) -> dict[str, Any]:
        """Name and options as plain data."""
        return {"name": self.NAME, "options": {f.name: _plain(getattr(self, f.name)) for f in fields(self)}}

    @classmethod
    def options_from_json(cls, options: Mapping[str, Any]) -> dict[str, Any]:
        """Keyword arguments from plain options: lists become tuples."""
        return {name: _tuples(value) for name, value in options.items()}


PROVIDERS = ("robust_core.stabilisation", "robust_core.filtering", "robust_core.observers", "robust_core.terminal")
"""Packages with theorems of their own, imported when a certificate names one that is not known yet."""


def theorem_from_json(content: Any) -> Theorem:
    """The theorem that :meth:`Theorem.to_json` described.

    Raises
    ------
    CertificateMismatchError: for an unknown theorem or other options than it has.
    """
    name, options = content["name"], content["options"]
    if name not in Theorem.REGISTRY:
        for package in PROVIDERS:
            import_module(package)
    kind = Theorem.REGISTRY.get(name)
    if kind is None:
        raise CertificateMismatchError(
            f"no theorem is called {name!r}; known are {', '.join(sorted(Theorem.REGISTRY))}"
        )
    known = {f.name for f in fields(kind)}
    if set(options) != known:
        raise CertificateMismatchError(f"theorem {name} has the options {sorted(known)}, got {sorted(options)}")
    try:
        return kind(**kind.options_from_json(options))
    except ArgumentError as error:
        raise CertificateMismatchError(f"theorem {name}: {error}") from error


def exact_option(name: str, value: Any) -> str:
    """A numeric option in its exact text form, so that it survives files: floats keep their binary value."""
    try:
        return _canonical(value) if isinstance(value, str) else str(rational(value))
    except ArgumentError as error:
        raise ArgumentError(name, "a finite number", repr(value)) from error


@lru_cache(maxsize=1024)
def _canonical(text: str) -> str:
    return str(rational(text))


@lru_cache(maxsize=1024)
def option_number(text: str, *, exact: bool) -> Any:
    """The number that an option's text stands for."""
    number = rational(text)
    return number if exact else float(to_float(np.array(number, dtype=object)))


def _plain(value: Any) -> Any:
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    if isinstance(value, np.integer):
        return int(value)
    return value


def _tuples(value: Any) -> Any:
    return tuple(_tuples(item) for item in value) if isinstance(value, list) else value
