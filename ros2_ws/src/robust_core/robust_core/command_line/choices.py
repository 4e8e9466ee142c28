"""Theorems, regions and indices by their names in specifications."""

from typing import Any

from robust_core.command_line.fields import Fields, SpecError
from robust_core.theorems import CommonLyapunov, ParameterDependent, Relaxed, Slack, TensorCorners, TensorProduct
from robust_core.theorems.lyapunov import LyapunovTheorem
from robust_core.theorems.regions import Region, disc, half_plane, intersection, sector

THEOREMS: dict[str, type[LyapunovTheorem]] = {
    kind.NAME: kind for kind in (CommonLyapunov, ParameterDependent, Relaxed, Slack, TensorCorners, TensorProduct)
}
INDICES = ("h_infinity", "energy_to_peak", "passive", "dissipative", "very_strictly_passive")


def region_of(asked: Fields) -> Region | None:
    """``region: {disc: [center, radius], half_plane: bound, sector: angle}``; several are intersected."""
    if not asked.has("region"):
        return None
    fields = asked.part("region")
    fields.only("disc", "half_plane", "sector")
    found = []
    with fields.about():
        if fields.has("disc"):
            numbers = fields.floats("disc")
            if numbers.shape != (2,):
                raise SpecError(fields.key("disc"), "must be [center, radius]")
            found.append(disc(float(numbers[0]), float(numbers[1])))
        if fields.has("half_plane"):
            found.append(half_plane(fields.number("half_plane")))
        if fields.has("sector"):
            found.append(sector(fields.number("sector")))
        return intersection(found)


def index_of(asked: Fields, z: int, w: int) -> Any:
    """``index: h_infinity``, or a mapping with ``kind`` and the numbers that dissipativity takes."""
    from robust_core import filtering

    value = asked.content.get("index")
    plain = value is None or isinstance(value, str)
    fields = Fields({"kind": value or "h_infinity"}, asked.key("index")) if plain else asked.part("index")
    fields.only("kind", "Q", "S", "R", "epsilon")
    kind = fields.text("kind", choices=INDICES)
    with fields.about():
        if kind == "dissipative":
            return filtering.dissipative(*(fields.array(name) for name in "QSR"))
        if kind == "very_strictly_passive":
            return filtering.very_strictly_passive(fields.number("epsilon"), z)
        if kind == "passive":
            return filtering.passive(z)
        return getattr(filtering, kind)(z, w)


def theorem_of(name: str, key: str) -> type[LyapunovTheorem]:
    """A stability theorem by its name."""
    if name not in THEOREMS:
        raise SpecError(key, f"must be one of {', '.join(THEOREMS)}, got {name!r}")
    return THEOREMS[name]
