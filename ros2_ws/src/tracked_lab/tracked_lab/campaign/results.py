"""What a campaign says: figures of every cell and way, and how much lower than the baseline's they are."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_lab.campaign.run_store import StoredRun
from tracked_lab.campaign.spec import CampaignSpec
from tracked_lab.statistics import Interval, latest_median, median_interval, reduction_percent

Array = NDArray[np.float64]
Cell = tuple[tuple[str, str], ...]
"""Axis and label, in the order of the spec."""

TRACKING = ("rms_x_m", "rms_y_m", "rms_theta_rad", "ptop_x_m", "ptop_y_m", "ptop_theta_rad")
FRAMES = ("true", "estimated")
RECOVERY = "recovery_s"


@dataclass(frozen=True, slots=True)
class CellResults:
    """One cell: figures by way and metric, over the seeds (NaN where a run has none)."""

    cell: Cell
    seeds: tuple[int, ...]
    values: Mapping[str, Mapping[str, Array]]

    @property
    def label(self) -> str:
        """The labels, as part of a key."""
        return ".".join(label for _, label in self.cell) or "all"

    @property
    def whole_seeds(self) -> int:
        """Seeds for which every way has figures: less than all while a campaign is not done."""
        driven = [
            np.logical_or.reduce([np.isfinite(each) for each in own.values()]) for own in self.values.values() if own
        ]
        return int(np.logical_and.reduce(driven).sum()) if len(driven) == len(self.values) else 0

    def median(self, way: str, metric: str) -> Interval | None:
        """Median of one figure; None without any, and where most runs never recovered.

        A run that never recovered counts as one that takes longer than every other: none is left out.
        """
        values = self.values[way].get(metric)
        if values is None or not np.isfinite(values).any():
            return None
        if metric.endswith(RECOVERY):
            return latest_median(np.where(np.isnan(values) & self._driven(way, metric), np.inf, values))
        return median_interval(values)

    def recovered_share(self, way: str, metric: str) -> float | None:
        """Of the runs that were disturbed, how many recovered; None if none was."""
        values, driven = self.values[way].get(metric), self._driven(way, metric)
        return None if values is None or not driven.any() else float(np.isfinite(values[driven]).mean())

    def _driven(self, way: str, metric: str) -> NDArray[np.bool_]:
        error = self.values[way].get(f"{metric.partition('.')[0]}.rms_x_m")
        return np.isfinite(error) if error is not None else np.zeros(len(self.seeds), dtype=np.bool_)

    def reduction(self, way: str, metric: str, baseline: str) -> Interval | None:
        """How much lower than the baseline's (%); None without pairs."""
        own, other = self.values[way].get(metric), self.values[baseline].get(metric)
        if own is None or other is None or not np.isfinite(own + other).any():
            return None
        return reduction_percent(other, own)


@dataclass(frozen=True, slots=True)
class CampaignResults:
    """All cells. runs: those of the spec that the store has; planned: how many there are to be."""

    spec: CampaignSpec
    cells: tuple[CellResults, ...]
    runs: tuple[StoredRun, ...]
    planned: int

    @property
    def failed(self) -> tuple[StoredRun, ...]:
        """Runs that have no figures."""
        return tuple(run for run in self.runs if not run.ok)

    @property
    def filled(self) -> str:
        """When the runs were made, and by which commits of the code."""
        times, commits = sorted(run.created for run in self.runs if run.created), {run.commit for run in self.runs}
        if not times:
            return "made at no known time"
        return f"made {times[0]} to {times[-1]} by commit {', '.join(sorted(commits - {''}))}"

    @property
    def main(self) -> CellResults:
        """The cell that matters most: the one that the spec names, else the first."""
        for results in self.cells:
            if self.spec.main and dict(results.cell) == self.spec.main:
                return results
        return self.cells[0]

    def figures(self) -> dict[str, float]:
        """Flat figures: ``<cell>.<way>.<metric>``, medians, reductions with their intervals, and counts."""
        found: dict[str, float] = {"runs": len(self.runs), "planned": self.planned, "failed": len(self.failed)}
        found["least_whole_seeds"] = min(results.whole_seeds for results in self.cells)
        baseline = self.spec.baseline_name
        for results in self.cells:
            found[f"{results.label}.whole_seeds"] = results.whole_seeds
            for way in self.spec.ways:
                for metric in results.values[way]:
                    middle = results.median(way, metric)
                    if middle is not None:
                        found[f"{results.label}.{way}.{metric}"] = middle.median
                    share = results.recovered_share(way, metric) if metric.endswith(RECOVERY) else None
                    if share is not None:
                        found[f"{results.label}.{way}.{metric.removesuffix('_s')}_share"] = share
                if way != baseline:
                    found |= self._reductions(results, way, baseline)
        return found

    def _reductions(self, results: CellResults, way: str, baseline: str) -> dict[str, float]:
        found = {}
        for frame in FRAMES:
            for name in TRACKING:
                lower = results.reduction(way, f"{frame}.{name}", baseline)
                if lower is not None:
                    key = f"{results.label}.{way}.{frame}.{name.rpartition('_')[0]}_lower"
                    found[f"{key}_percent"] = lower.median
                    found[f"{key}_least_percent"] = lower.low
                    found[f"{key}_most_percent"] = lower.high
        return found


def gather(spec: CampaignSpec, stored: Mapping[str, StoredRun]) -> CampaignResults:
    """Results of the runs of the spec that the store has.

    Raises
    ------
    ValueError: if it has none.
    """
    planned = spec.runs()
    runs = [(inputs, stored[inputs.key]) for inputs in planned if inputs.key in stored]
    if not any(run.ok for _, run in runs):
        raise ValueError(f"the store has no run of campaign {spec.name}: run it first")
    seeds = tuple(spec.seeds.values())
    place = {seed: index for index, seed in enumerate(seeds)}
    cells = []
    for cell in spec.cells():
        values: dict[str, dict[str, Array]] = {way: {} for way in spec.ways}
        for inputs, run in runs:
            if inputs.cell != cell or not run.ok:
                continue
            for metric, value in run.values.items():
                column = values[inputs.way].setdefault(metric, np.full(len(seeds), np.nan))
                column[place[inputs.scenario.seed]] = value
        cells.append(CellResults(tuple(cell.items()), seeds, values))
    return CampaignResults(spec, tuple(cells), tuple(run for _, run in runs), len(planned))


def rows_of(stored: Sequence[StoredRun]) -> list[dict[str, object]]:
    """One flat row per run, for CSV."""
    rows = []
    for run in stored:
        fixed = {"key": run.key, "way": run.way, "seed": run.seed, "status": run.status}
        rows.append(fixed | dict(run.cell) | {"wall_s": run.wall_s, "cpu_s": run.cpu_s} | dict(run.values))
    return rows
