"""Scenario: what is run, where, how and in which variants; schema of the scenario files."""

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from tracked_types import PIPELINE_LATENCY_S, PLAN_RATE_HZ
from tracked_types.checked_yaml import CheckedModel, ReadableFile, load_checked_yaml

Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$")]
Finite = Annotated[float, Field(allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
Value = bool | int | float | str | list[float] | list[str]
Parameters = dict[Name, dict[str, Value]]
"""Node name -> parameter name -> value."""


class StartPose(CheckedModel):
    """Start pose of base_footprint in the world."""

    x_m: Finite
    y_m: Finite
    yaw_rad: Finite = 0.0


def _kind_of_start(value: Any) -> str:
    return "name" if isinstance(value, str) else "pose"


Start = Annotated[
    Annotated[Name, Tag("name")] | Annotated[StartPose, Tag("pose")],
    Discriminator(_kind_of_start),
]


class Reference(CheckedModel):
    """What the robot is asked to follow: a named shape with parameters, or a trajectory file."""

    shape: Name | None = None
    file: str | None = None
    parameters: dict[str, int | Finite] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _one_source(self) -> "Reference":
        if (self.shape is None) == (self.file is None):
            raise ValueError("give exactly one of shape and file")
        return self


class Variant(CheckedModel):
    """One way to drive the scenario; every variant runs on the same seed and is compared with the baseline."""

    description: str = ""
    layers: Literal["single", "double"] = "double"
    method: Literal["improved", "thesis"] = "improved"
    suspension: Literal["qzs", "linear", "locked"] | None = None
    parameters: Parameters = Field(default_factory=dict)


class Fault(CheckedModel):
    """Fault injected into the simulator; which kinds and targets exist is the simulator's to say.

    ``at_s`` is simulated time, which starts at zero; ``duration_s`` None: to the end.
    """

    at_s: NotNegative
    kind: Name
    target: Annotated[str, Field(min_length=1)]
    duration_s: Positive | None = None
    value: Finite = 0.0


class Scenario(CheckedModel):
    """Everything a run needs; ``robot`` is the path of a robot file, or empty for the packaged one.

    Errors name the offending key (``variants.double.layers``). ``world``, ``start`` and ``reference.shape``
    are names that their owners (simulator, trajectory player) resolve.
    """

    name: Name
    description: str = ""
    robot: str = ""
    world: Annotated[str, Field(min_length=1)]
    start: Start = "default"
    seed: Annotated[int, Field(ge=0, lt=2**32)] = 1
    duration_s: Annotated[float, Field(gt=0.0, le=3600.0, allow_inf_nan=False)]
    reference: Reference | None = None
    suspension: Literal["qzs", "linear", "locked"] | None = None
    time: Literal["lock_step", "paced", "unpaced"] = "lock_step"
    plan_rate_hz: Annotated[int, Field(ge=1, le=30)] = PLAN_RATE_HZ
    pipeline_latency_s: Annotated[float, Field(ge=0.0, le=1.0, allow_inf_nan=False)] = PIPELINE_LATENCY_S
    nodes: dict[Name, bool] = Field(default_factory=dict)
    parameters: Parameters = Field(default_factory=dict)
    faults: tuple[Fault, ...] = ()
    variants: dict[Name, Variant] = Field(default_factory=lambda: {"double": Variant()}, min_length=1)
    baseline: Name | None = None

    @model_validator(mode="after")
    def _consistent(self) -> "Scenario":
        if self.baseline is not None and self.baseline not in self.variants:
            raise ValueError(f"baseline must be one of the variants {', '.join(self.variants)}; got {self.baseline!r}")
        for index, fault in enumerate(self.faults):
            if fault.at_s >= self.duration_s:
                raise ValueError(
                    f"faults.{index}.at_s must lie within duration_s {self.duration_s:g}, got {fault.at_s:g}"
                )
        return self

    @property
    def navigates(self) -> bool:
        """Whether the robot drives to goals on a map instead of along a reference that is known beforehand."""
        return self.nodes.get("navigator", False)

    @property
    def drives(self) -> bool:
        """Whether anybody gives the layers something to follow."""
        return self.reference is not None or self.navigates

    def waits_for_goals(self, variant: str) -> bool:
        """Whether the robot navigates and is sent by others while it runs. Raises KeyError for an unknown variant."""
        goals = self.parameters_of(variant).get("navigator", {}).get("goals", ())
        return self.navigates and not (isinstance(goals, list | tuple) and len(goals) > 1)

    @property
    def baseline_name(self) -> str:
        """Variant the others are compared with: the one named, else the first."""
        return self.baseline or next(iter(self.variants))

    def parameters_of(self, variant: str) -> dict[str, dict[str, Value]]:
        """Node parameters of one variant: the scenario's, overridden by the variant's own.

        Raises KeyError for an unknown variant.
        """
        merged = {node: dict(values) for node, values in self.parameters.items()}
        for node, values in self.variants[variant].parameters.items():
            merged.setdefault(node, {}).update(values)
        return merged

    def suspension_of(self, variant: str) -> str | None:
        """Suspension of one variant; None means what robot.yaml says. Raises KeyError for an unknown variant."""
        return self.variants[variant].suspension or self.suspension


def load_scenario(source: Path | str | ReadableFile, name: str | None = None) -> Scenario:
    """Read and check a scenario file; ``name`` is how errors call it.

    Raises
    ------
    CheckedFileError: if the file is missing, is not YAML, or a key is missing, unknown or out of range.
    """
    return load_checked_yaml(Scenario, Path(source) if isinstance(source, str) else source, name)
