"""What a campaign runs: ways to drive, seeds, and axes that change the scenario or the conditions."""

import itertools
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, ValidationError, model_validator

from tracked_lab.campaign.run_inputs import RunInputs, hash_of, unknown_way
from tracked_lab.conditions import Conditions
from tracked_lab.peers import PEER_WEIGHTS, PEERS
from tracked_lab.peers.tuned import tuned_parameters
from tracked_lab.table_variants import TABLE_VARIANTS, packaged_weights
from tracked_report.scenario import Scenario
from tracked_types.checked_yaml import CheckedFileError, CheckedModel, explain, load_checked_yaml

Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$")]
Label = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9_]*$")]
Changes = dict[str, Any]
"""Dotted path below ``scenario`` or ``conditions`` -> value, such as ``scenario.pipeline_latency_s: 0.2``."""


class Seeds(CheckedModel):
    """``count`` consecutive seeds from ``first`` on."""

    first: Annotated[int, Field(ge=0, lt=2**32)] = 1
    count: Annotated[int, Field(ge=1, le=100_000)] = 10

    def values(self) -> range:
        """The seeds."""
        return range(self.first, self.first + self.count)


class CampaignSpec(CheckedModel):
    """A campaign file.

    axes: name -> label -> what it changes. design grid: every combination of labels, ways and seeds; random:
    ``samples`` combinations of labels drawn with ``draw_seed``, each with every way and all seeds. baseline: the way
    that others are compared with. main: the labels of the cell that matters most, one for each axis.
    """

    name: Name
    description: str = ""
    scenario: Scenario
    conditions: Conditions = Conditions()
    ways: Annotated[tuple[Name, ...], Field(min_length=1)]
    seeds: Seeds = Seeds()
    axes: dict[Name, dict[Label, Changes]] = Field(default_factory=dict)
    design: Literal["grid", "random"] = "grid"
    samples: Annotated[int, Field(ge=1)] = 10
    draw_seed: Annotated[int, Field(ge=0)] = 0
    baseline: Name | None = None
    main: dict[Name, Label] = Field(default_factory=dict)
    time_limit_s: Annotated[float, Field(gt=0.0, le=3600.0)] = 120.0

    @model_validator(mode="after")
    def _consistent(self) -> "CampaignSpec":
        if self.baseline is not None and self.baseline not in self.ways:
            raise ValueError(f"baseline must be one of the ways {', '.join(self.ways)}; got {self.baseline!r}")
        for axis, labels in self.axes.items():
            if not labels:
                raise ValueError(f"axes.{axis} has no labels: the grid would be empty")
        for axis, label in self.main.items():
            if label not in self.axes.get(axis, {}):
                raise ValueError(f"main.{axis} must be a label of an axis; got {label!r}")
        for way in self.ways:
            if way not in self.scenario.variants and way not in TABLE_VARIANTS and way not in PEERS:
                raise unknown_way(way, self.scenario)
        return self

    @property
    def baseline_name(self) -> str:
        """The way that others are compared with: the one named, else the first."""
        return self.baseline or self.ways[0]

    def cells(self) -> list[dict[str, str]]:
        """Labels by axis of every cell."""
        every = [dict(zip(self.axes, labels, strict=True)) for labels in itertools.product(*self.axes.values())]
        if self.design == "random" and self.samples < len(every):
            chosen = np.random.default_rng(self.draw_seed).choice(len(every), self.samples, replace=False)
            every = [every[index] for index in sorted(chosen.tolist())]
        return every

    def main_part(self) -> "CampaignSpec":
        """Only the cell that matters most; of axes that ``main`` does not name, every label."""
        axes = {axis: {label: self.axes[axis][label]} for axis, label in self.main.items()}
        return self.model_copy(update={"axes": self.axes | axes})

    def runs(self) -> list[RunInputs]:
        """Every run, seed by seed, so that a campaign cut short has whole pairs.

        Raises
        ------
        CheckedFileError: if an axis changes what does not exist or to what is not allowed.
        """
        planned = []
        weights = {way: hash_of(packaged_weights(way)) for way in self.ways if self._is_tabled(way)}
        weights |= {way: hash_of(packaged_weights(PEER_WEIGHTS[way])) for way in self.ways if way in PEER_WEIGHTS}
        peers = {way: tuned_parameters(way) for way in self.ways if way in PEERS}
        cells = [(cell, *self._changed(cell)) for cell in self.cells()]
        for seed in self.seeds.values():
            for cell, scenario, conditions in cells:
                seeded = scenario.model_copy(update={"seed": seed})
                for way in self.ways:
                    own = conditions
                    if way in peers:
                        own = conditions.model_copy(update={"steering_parameters": peers[way]})
                    planned.append(
                        RunInputs(scenario=seeded, way=way, conditions=own, cell=cell, weights=weights.get(way, ""))
                    )
        return planned

    def _is_tabled(self, way: str) -> bool:
        return way in TABLE_VARIANTS and way not in self.scenario.variants

    def _changed(self, cell: Mapping[str, str]) -> tuple[Scenario, Conditions]:
        content: dict[str, Any] = {
            "scenario": self.scenario.model_dump(mode="json"),
            "conditions": self.conditions.model_dump(mode="json"),
        }
        for axis, label in cell.items():
            for path, value in self.axes[axis][label].items():
                _set(content, path, value, f"{self.name}: axes.{axis}.{label}")
        try:
            return Scenario.model_validate(content["scenario"]), Conditions.model_validate(content["conditions"])
        except ValidationError as error:
            raise CheckedFileError(f"{self.name}: cell {dict(cell)}: {explain(error)}") from error


def load_spec(name: str) -> CampaignSpec:
    """A campaign by the path of its file, or a packaged one by its name.

    Raises
    ------
    CheckedFileError: if there is none, or a key is missing, unknown or out of range.
    """
    packaged = resources.files("tracked_lab") / "data" / "campaigns"
    if "/" not in name and not name.endswith(".yaml"):
        names = sorted(Path(str(file)).stem for file in packaged.iterdir())
        if name not in names:
            raise CheckedFileError(f"there is no campaign {name!r}; packaged are {', '.join(names)}, or give a file")
        return load_checked_yaml(CampaignSpec, packaged / f"{name}.yaml", f"{name}.yaml")
    return load_checked_yaml(CampaignSpec, Path(name))


def _set(content: dict[str, Any], path: str, value: Any, where: str) -> None:
    *way, last = path.split(".")
    place = content
    for step in way:
        below = place.get(step)
        if not isinstance(below, dict):
            raise CheckedFileError(f"{where}: there is no {path}")
        place = below
    if place is content:
        raise CheckedFileError(f"{where}: {path} must begin with scenario. or conditions.")
    place[last] = value
