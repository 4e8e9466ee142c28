"""The ways to drive that Table 5.1 compares, and whose weights are searched for each."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path

from tracked_lab.conditions import Conditions
from tracked_report.scenario import Variant

BASELINE = "single"


@dataclass(frozen=True, slots=True)
class TableVariant:
    """One way to drive.

    variant: for a scenario. conditions: what it changes of the lab's conditions. roles: the weights that it uses, of
    those called single, upper and lower.
    """

    description: str
    variant: Variant
    roles: tuple[str, ...]
    conditions: Mapping[str, object] = field(default_factory=dict)

    @property
    def method(self) -> str:
        """Whose weights in a weights file."""
        return self.variant.method

    def with_weights(self, file: Path | str) -> Variant:
        """The scenario's variant with the weights of a file."""
        parameters = {node: dict(values) for node, values in self.variant.parameters.items()}
        for node in ("upper_nmpc", "lower_nmpc"):
            parameters.setdefault(node, {})["weights_file"] = str(file)
        return self.variant.model_copy(update={"parameters": parameters})

    def with_weights_in(self, conditions: Conditions, file: Path | str) -> Conditions:
        """``conditions`` with what this way to drive changes of them."""
        changed = dict(self.conditions)
        if "steering" in changed:
            changed["steering_parameters"] = {"weights_file": str(file)}
        return conditions.model_copy(update=changed)


def _nodes(**nodes: dict[str, object]) -> Variant:
    return Variant.model_validate({"parameters": nodes})


TABLE_VARIANTS: Mapping[str, TableVariant] = {
    "single": TableVariant("5 Hz layer alone", Variant(layers="single"), ("single",)),
    "single_predicted": TableVariant(
        "5 Hz layer alone, from the state predicted over its latency",
        Variant.model_validate({"layers": "single", "parameters": {"upper_nmpc": {"predict_latency": True}}}),
        ("single",),
    ),
    "double_without_slip": TableVariant(
        "both layers, improved, slip not compensated",
        _nodes(upper_nmpc={"slide_compensation": False}, lower_nmpc={"slip_compensation": False}),
        ("upper", "lower"),
    ),
    "double_as_printed": TableVariant("both layers as printed", Variant(method="thesis"), ("upper", "lower")),
    "double_improved": TableVariant("both layers, improved", Variant(), ("upper", "lower")),
    "one_30hz_layer": TableVariant(
        "one 30 Hz layer along the reference, improved", Variant(), ("lower",), {"steering": "fast_layer"}
    ),
    "oracle_slip": TableVariant(
        "both layers, improved, told the true slip",
        _nodes(lower_nmpc={"speed_slip": True}),
        ("upper", "lower"),
        {"slip_source": "oracle"},
    ),
}


def packaged_weights(name: str) -> Path:
    """The weights found for a way to drive; they are written by ``make tune``."""
    return Path(str(resources.files("tracked_lab") / "data" / "weights" / f"{name}.yaml"))
