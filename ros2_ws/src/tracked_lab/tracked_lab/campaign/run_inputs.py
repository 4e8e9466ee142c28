"""Everything that one run of a campaign depends on, and the key that it is known by."""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path

from pydantic import Field

from tracked_lab.conditions import Conditions
from tracked_lab.lock_step import drive
from tracked_lab.peers import PEER_WEIGHTS, PEERS
from tracked_lab.table_variants import TABLE_VARIANTS, packaged_weights
from tracked_report.metrics import run_metrics
from tracked_report.run_record import RunRecord
from tracked_report.scenario import Scenario
from tracked_types.checked_yaml import CheckedModel

FORMAT = 3
"""Of keys and stored rows; raised also where the same inputs give other figures. A store of another one is refused."""


class UnknownWayError(ValueError):
    """A way to drive has no meaning; the text lists those that have."""


class RunInputs(CheckedModel):
    """One run.

    way: a variant of the scenario, a way of Table 5.1 with its tuned weights, or a peer. cell: the labels of its axes.
    weights: hash of the weights file that the way has, so that other weights are another run.
    """

    scenario: Scenario
    way: str
    conditions: Conditions = Conditions()
    cell: dict[str, str] = Field(default_factory=dict)
    weights: str = ""

    @property
    def key(self) -> str:
        """Hash of everything but the labels, 20 hex digits."""
        content = self.model_dump(mode="json", exclude={"cell"}) | {"format": FORMAT}
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:20]

    def record(self) -> RunRecord:
        """Drive.

        Raises
        ------
        UnknownWayError: if nobody drives this way.
        ValueError: as `tracked_lab.lock_step.drive`, and if the weights have changed since the campaign was planned.
        """
        if self.way in self.scenario.variants:
            return drive(self.scenario, self.way, conditions=self.conditions)
        if self.weights:
            file = packaged_weights(PEER_WEIGHTS.get(self.way, self.way))
            if self.weights != hash_of(file):
                raise ValueError(f"the weights in {file.name} have changed since this run was planned")
        if self.way in TABLE_VARIANTS:
            way, file = TABLE_VARIANTS[self.way], packaged_weights(self.way)
            scenario = self.scenario.model_copy(update={"variants": {self.way: way.with_weights(file)}})
            return drive(scenario, self.way, conditions=way.with_weights_in(self.conditions, file))
        if self.way in PEERS:
            conditions = self.conditions.model_copy(update={"steering": self.way})
            return drive(self.scenario, next(iter(self.scenario.variants)), conditions=conditions)
        raise unknown_way(self.way, self.scenario)

    def figures(self) -> Mapping[str, float]:
        """Drive, and measure."""
        return run_metrics(self.record()).values


def unknown_way(way: str, scenario: Scenario) -> UnknownWayError:
    """The error for a way that nobody drives."""
    known = ", ".join([*scenario.variants, *TABLE_VARIANTS, *PEERS])
    return UnknownWayError(f"unknown way to drive {way!r}; there are {known}")


def hash_of(file: Path) -> str:
    """Hash of a file's content, 12 hex digits."""
    return hashlib.sha256(file.read_bytes()).hexdigest()[:12]
