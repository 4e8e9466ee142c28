"""Systems of specifications as models: vertices in numbers, or formulas over a box."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from robust_core.command_line.expressions import CONSTANTS, FUNCTIONS, formula
from robust_core.command_line.fields import Fields, SpecError
from robust_core.models import FilterPlant, PolytopicSystem
from robust_core.models.lipschitz_plant import LipschitzPlant

SHARED = ("groups", "totals")
VERTICES = ("vertices", *SHARED, "rates")
FORMULAS = ("states", "box", "terms", "weights", "vertices", "A", "B", *SHARED, "rates")


@dataclass(frozen=True, slots=True)
class Formulas:
    """A symbolic model, how its rates are bounded, and what it is made of."""

    model: Any
    rates: str
    states: tuple[str, ...]

    def system(self, values: Sequence[float] = (), rates: Any = None) -> PolytopicSystem:
        """The polytopic model for one set of parameters; rates are bounded unless given or not wanted."""
        if rates is None and self.rates != "none":
            rates = self.model.rates(values, method=self.rates)
        model: PolytopicSystem = self.model.system(values, rates=rates)
        return model


def polytopic(system: Fields) -> tuple[PolytopicSystem, Formulas | None]:
    """The model of x' = sum_r sigma_r (A_r x + B_r u), and its formulas where it has some."""
    if system.has("states"):
        formulas = read_formulas(system, ())
        return formulas.system(), formulas
    system.only(*VERTICES)
    vertices = system.part("vertices")
    vertices.only("A", "B")
    with vertices.about():
        model = PolytopicSystem.of(
            vertices.array("A"),
            vertices.array("B") if vertices.has("B") else None,
            rates=system.floats("rates") if system.has("rates") else None,
            **groups_of(system),
        )
    return model, None


def read_formulas(system: Fields, parameters: Sequence[str], *, check: bool = True) -> Formulas:
    """Formulas over a box, with parameters by name.

    Raises
    ------
    SpecError: naming the key. ModelMismatchError: where weights and vertices do not mix to A and B.
    """
    from robust_core.symbolic import StateDependentModel, Term, check_agreement, derive
    from robust_core.symbolic.packages import casadi_module

    casadi = casadi_module()
    system.only(*FORMULAS)
    states = _names(system)
    x = casadi.SX.sym("x", len(states))
    p: Any = casadi.SX.sym("p", len(parameters)) if parameters else None
    symbols = {name: x[k] for k, name in enumerate(states)} | {name: p[k] for k, name in enumerate(parameters)}
    if len(symbols) != len(states) + len(parameters):
        raise SpecError(system.key("states"), "share a name with the parameters")
    low, high = _box(system, states)

    def matrix(fields: Fields, name: str, names: dict[str, Any]) -> Any:
        entries = fields.entries(name, lambda text: formula(text, names))
        if entries.ndim != 2 or len(entries) != len(states) or entries.size == 0:
            raise SpecError(fields.key(name), f"must be a matrix of {len(states)} rows, got shape {entries.shape}")
        return casadi.vertcat(*[casadi.horzcat(*row) for row in entries])

    rates = system.text("rates", "enclosed", ("enclosed", "sampled", "none"))
    common: dict[str, Any] = {"states": x, "low": low, "high": high, "parameters": p}
    has_input = system.has("B")
    if system.has("terms"):
        for name in ("weights", "vertices", *SHARED):
            if system.has(name):
                raise SpecError(system.key(name), "follows from terms: leave one of the two out")
        named = _terms(system, symbols)
        constant = {name: value for name, value in symbols.items() if name in parameters}

        def of_terms(name: str) -> Any:
            return lambda *values: matrix(system, name, constant | dict(zip(named, values, strict=True)))

        with system.about():
            model = derive(
                **common,
                terms=[Term(*term) for term in named.values()],
                matrix=of_terms("A"),
                input_matrix=of_terms("B") if has_input else None,
            )
    else:
        weights = system.entries("weights", lambda text: formula(text, symbols)).tolist()
        vertices = system.part("vertices")
        vertices.only("A", "B")
        constant = {name: value for name, value in symbols.items() if name in parameters}
        with system.about():
            model = StateDependentModel.of(
                **common,
                matrix=matrix(system, "A", symbols),
                input_matrix=matrix(system, "B", symbols) if has_input else None,
                weights=casadi.vertcat(*weights),
                vertices=_stack(vertices, "A", constant, matrix),
                inputs=_stack(vertices, "B", constant, matrix) if has_input else None,
                **groups_of(system),
            )
    if check:
        check_agreement(model, np.linspace(0.37, 1.3, len(parameters)))
    return Formulas(model, rates, states)


def _stack(vertices: Fields, name: str, constant: dict[str, Any], matrix: Any) -> list[Any]:
    listed = vertices.get(name, "one matrix per weight")
    if not isinstance(listed, list):
        raise SpecError(vertices.key(name), "must be a list of matrices, one per weight")
    return [
        matrix(Fields({f"{name}[{k}]": one}, vertices.place), f"{name}[{k}]", constant) for k, one in enumerate(listed)
    ]


def filter_plant(system: Fields) -> FilterPlant:
    """x' = A x + B w, z = C x + D w, y = E x + F w at the vertices; ``attained: true`` takes the true ones."""
    system.only("vertices", *SHARED, "attained")
    vertices = system.part("vertices")
    vertices.only("A", "B", "C", "D", "E", "F")
    given = {name: vertices.array(name) for name in "ABCDEF" if vertices.has(name) or name in "ABCE"}
    with vertices.about():
        plant = FilterPlant.of(**given, **groups_of(system))
    attained = system.content.get("attained", False)
    if not isinstance(attained, bool):
        raise SpecError(system.key("attained"), "must be true or false")
    return plant.attained() if attained else plant


def lipschitz_plant(system: Fields) -> LipschitzPlant:
    """x+ = A x + Df f(x) + B u + D d, y = C x."""
    names = ("A", "B", "C", "Df", "D")
    system.only(*names)
    given = {name: system.array(name) for name in names}
    for name, matrix in given.items():
        if matrix.ndim != 2:
            raise SpecError(system.key(name), f"must be a matrix, a list of rows, got shape {matrix.shape}")
    with system.about():
        return LipschitzPlant.of(**given)


def groups_of(system: Fields) -> dict[str, Any]:
    """Keyword arguments that say which weights sum to what."""
    out: dict[str, Any] = {}
    if system.has("groups"):
        listed = system.get("groups", "lists of weights")
        if not isinstance(listed, list) or not all(
            isinstance(group, list) and all(isinstance(k, int) and not isinstance(k, bool) for k in group)
            for group in listed
        ):
            raise SpecError(system.key("groups"), "must be lists of weights, counted from 0, as [[0, 1], [2, 3]]")
        out["groups"] = listed
    if system.has("totals"):
        out["totals"] = system.array("totals").tolist()
    return out


def _names(system: Fields) -> tuple[str, ...]:
    names = system.get("states", "names of the states, as [x1, x2]")
    if not isinstance(names, list) or not names or not all(isinstance(n, str) and n.isidentifier() for n in names):
        raise SpecError(system.key("states"), "must be a list of names, as [x1, x2]")
    reserved = {*FUNCTIONS, *CONSTANTS} & set(names)
    if reserved or len(set(names)) < len(names):
        raise SpecError(system.key("states"), f"must differ from each other and from {', '.join(sorted(reserved))}")
    return tuple(names)


def _box(system: Fields, states: Sequence[str]) -> tuple[Any, Any]:
    box = system.part("box")
    box.only(*states)
    sides = [box.floats(name) for name in states]
    for name, side in zip(states, sides, strict=True):
        if side.shape != (2,) or not side[0] < side[1]:
            raise SpecError(box.key(name), f"must be [low, high] with low below high, got {box.content[name]}")
    return np.array([side[0] for side in sides]), np.array([side[1] for side in sides])


def _terms(system: Fields, symbols: dict[str, Any]) -> dict[str, tuple[Any, float | None, float | None]]:
    terms, out = system.part("terms"), {}
    for name in terms.content:
        if not name.isidentifier() or name in symbols or name in (*FUNCTIONS, *CONSTANTS):
            raise SpecError(terms.key(name), "is no name that is free")
        value = terms.content[name]
        part = terms.part(name) if isinstance(value, dict) else Fields({"formula": value}, terms.key(name))
        part.only("formula", "low", "high")
        with part.about("formula"):
            expression = formula(part.get("formula", "a formula of the states"), symbols)
        bounds = [part.number(side) if part.has(side) else None for side in ("low", "high")]
        out[name] = (expression, bounds[0], bounds[1])
    return out
