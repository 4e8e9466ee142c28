"""``map``: theorems asked at every point of a grid of parameters."""

import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from robust_core.analysis import sweep
from robust_core.command_line.choices import theorem_of
from robust_core.command_line.fields import Fields, SpecError
from robust_core.command_line.outcome import Outcome
from robust_core.command_line.plots import draw_map
from robust_core.command_line.spec import Spec
from robust_core.command_line.systems import read_formulas
from robust_core.models import PolytopicSystem
from robust_core.rational import Floats
from robust_core.verdict import Verdict

_LARGEST_MAP = 1_000_000


@dataclass(frozen=True)
class FamilyOfSpec:
    """Models of a specification's system for rows of parameters; plain data, so that processes can have it."""

    system: str
    parameters: tuple[str, ...]

    def __call__(self, points: Floats) -> Sequence[PolytopicSystem]:
        """One model per row of ``points`` (N, p), with rates bounded for all rows together."""
        formulas = read_formulas(Fields(json.loads(self.system), "system"), self.parameters, check=False)
        rates: Sequence[Any] = [None] * len(points)
        if formulas.rates != "none":
            rates = formulas.model.rate_map().bounds(points, method=formulas.rates)
        return [formulas.system(row, bounds) for row, bounds in zip(points.tolist(), rates, strict=True)]


def make_map(spec: Spec, folder: Path, workers: int | None) -> Outcome:
    """Verdicts at all points, also written as map.csv; an interrupted map goes on from ``folder``/map.jsonl."""
    asked = spec.asked
    asked.only("parameters", "theorems")
    names, axes = _axes(asked.part("parameters"))
    listed = asked.get("theorems", "a list of theorems")
    if not isinstance(listed, list) or not listed:
        raise SpecError(asked.key("theorems"), "must be a list of theorems")
    theorems = [theorem_of(str(name), asked.key("theorems"))() for name in listed]
    points = np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=1)
    if len(points) > _LARGEST_MAP:
        raise SpecError(asked.key("parameters"), f"make {len(points)} points, more than {_LARGEST_MAP}")
    read_formulas(spec.system, names)  # errors before any process starts
    folder.mkdir(parents=True, exist_ok=True)
    family = FamilyOfSpec(json.dumps(spec.system.content), names)
    found = sweep(theorems, family, points, workers=workers, progress=_progress, file=folder / "map.jsonl")
    _write_table(folder / "map.csv", names, [str(name) for name in listed], found)
    layers, notes, open_points = [], [], 0
    for row, theorem in enumerate(theorems):
        proven, ruled_out = found.count(row, Verdict.PROVEN), found.count(row, Verdict.INFEASIBLE)
        rest = len(points) - proven - ruled_out
        open_points += rest
        layers.append((f"theorem {theorem.NAME} ({proven})", found.verdicts[row] == Verdict.PROVEN))
        notes.append(
            f"theorem {theorem.NAME}: proven at {proven}, proven to say nothing at {ruled_out}, open at {rest}"
        )
    notes.append("the verdict at every point is in map.csv")
    verdict = Verdict.UNDECIDED if open_points else Verdict.PROVEN
    reason = f"{open_points} verdicts are open" if open_points else "every verdict is proven in exact arithmetic"
    ordered = sorted(layers, key=lambda layer: int(layer[1].sum()))
    return Outcome(
        verdict,
        reason,
        (f"{', '.join(f'theorem {t.NAME}' for t in theorems)} at {len(points)} points of {', '.join(names)}",),
        tuple(notes),
        draw=(lambda figure: draw_map(figure, points, names, ordered)) if len(names) <= 2 else None,
        size_in=(8.5, 5.0),
    )


def _axes(parameters: Fields) -> tuple[tuple[str, ...], list[Floats]]:
    if not parameters.content:
        raise SpecError(parameters.place, "needs at least one parameter")
    axes = []
    for name in parameters.content:
        if not name.isidentifier():
            raise SpecError(parameters.key(name), "is no name")
        axis = parameters.part(name)
        axis.only("low", "high", "count")
        low, high, count = axis.number("low"), axis.number("high"), axis.whole("count", low=2, high=10_001)
        if not low < high:
            raise SpecError(axis.key("high"), f"must be above low, got {low:g} to {high:g}")
        axes.append(np.linspace(low, high, count))
    return tuple(parameters.content), axes


def _write_table(path: Path, names: Sequence[str], theorems: Sequence[str], found: Any) -> None:
    lines = [",".join([*names, *(f"theorem {name}" for name in theorems)])]
    for k, point in enumerate(found.points.tolist()):
        lines.append(",".join([*map(repr, point), *(verdicts[k].value for verdicts in found.verdicts)]))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _progress(done: int, total: int) -> None:
    if sys.stderr.isatty():
        print(f"\r{done} of {total}", end="\n" if done == total else "", file=sys.stderr, flush=True)
