"""What a user would pick instead of the two layers: errors and processor time in one table.

Errors are medians over the seeds of the packaged campaign ``peers`` (kinematic plant) and, over a few seeds, of
``peers_belts``; both go on where their stores stop. The time of a tick is what all that is due at one 30 Hz instant
takes of its thread: for two layers the lower one, and in every sixth tick the upper one too; what holds its command
between the instants of 5 Hz has ticks of zero. It is measured here, the ways taking turns on the same seeds, so that
ratios hold on a busy machine.
"""

import argparse
import os
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tracked_lab.campaign.campaign_report import publish_campaign
from tracked_lab.campaign.command_line import run_campaign
from tracked_lab.campaign.results import CampaignResults, CellResults
from tracked_lab.campaign.run_store import RunStore
from tracked_lab.campaign.spec import CampaignSpec, load_spec
from tracked_report.plots.style import INK, new_figure, styled, variant_colour
from tracked_report.results import output_folder, write_metrics
from tracked_report.run_record import RunRecord
from tracked_report.terminal import render_table

Array = NDArray[np.float64]
AXES = ("x_m", "y_m", "theta_rad")
FIGURES = tuple(f"true.{kind}_{axis}" for kind in ("rms", "ptop") for axis in AXES)
HEADS = (
    "",
    *(f"{kind} {axis}" for kind in ("RMS", "PtoP") for axis in ("x mm", "y mm", "mrad")),
    "tick ms",
    "median",
    "p99",
)
ROUNDS, QUICK_SEEDS = 3, 2


def tick_times(record: RunRecord) -> Array:
    """Thread CPU time (ms) of every tick that gave a command."""
    by_stamp = dict.fromkeys(record.channel("cmd_vel_nav").stamps_ns.tolist(), 0.0)
    for name in ("upper_status", "lower_status"):
        if name in record.channels:
            channel = record.channel(name)
            for stamp, seconds in zip(channel.stamps_ns.tolist(), channel.column("cpu_time_s").tolist(), strict=True):
                if stamp in by_stamp:
                    by_stamp[stamp] += 1e3 * seconds
    return np.array(list(by_stamp.values()))


def processor_times(spec: CampaignSpec, rounds: int) -> dict[str, Array]:
    """Tick times (ms) of every way in the main cell, the ways taking turns; a run's first tick is left out."""
    times: dict[str, list[Array]] = {way: [] for way in spec.ways}
    first = list(spec.seeds.values())[:rounds]
    for inputs in spec.runs():
        if inputs.scenario.seed in first and inputs.cell == (spec.main or inputs.cell):
            times[inputs.way].append(tick_times(inputs.record())[1:])
    return {way: np.concatenate(found) for way, found in times.items()}


def errors_of(name: str, seeds: int | None, workers: int) -> CampaignResults:
    """Run what is missing of a campaign, and publish its own report."""
    spec = load_spec(name)
    if seeds:
        spec = spec.main_part().model_copy(update={"seeds": spec.seeds.model_copy(update={"count": seeds})})
    store = RunStore(output_folder() / "campaigns" / spec.name)
    results = run_campaign(spec, store, scheduler=None, workers=workers)
    _, page = publish_campaign(results, f"{name}_quick" if seeds else None)
    print(page)
    return results


def table(cell: CellResults, ways: Sequence[str], times: Mapping[str, Array] | None) -> str:
    """Errors and, where they were measured, times."""
    rows = []
    for way in ways:
        medians = [cell.median(way, figure) for figure in FIGURES]
        row = [way, *("-" if middle is None else f"{1e3 * middle.median:.1f}" for middle in medians)]
        if times is not None:
            row += [f"{number:.3f}" for number in _summary(times[way])]
        rows.append(row)
    heads = HEADS if times is not None else HEADS[: 1 + len(FIGURES)]
    return render_table(rows, heads, ("left", *("right",) * (len(heads) - 1)))


def _summary(ticks: Array) -> tuple[float, float, float]:
    """Mean, median and 99th percentile."""
    return float(ticks.mean()), float(np.median(ticks)), float(np.percentile(ticks, 99))


def plot(cell: CellResults, times: Mapping[str, Array], file: Path) -> None:
    """Error over processor time, both in logarithms: below and to the left is better."""
    with styled():
        figure = new_figure(7.0, 4.0)
        axes = figure.subplots()
        for index, (way, ticks) in enumerate(times.items()):
            middles = [cell.median(way, f"true.rms_{axis}") for axis in AXES[:2]]
            error_mm = 1e3 * float(np.hypot(*(middle.median if middle else np.nan for middle in middles)))
            place = (float(ticks.mean()), error_mm)
            axes.plot(*place, "o", color=variant_colour(index))
            axes.annotate(way, place, xytext=(5, 3), textcoords="offset points", color=INK)
        axes.set(
            xscale="log", yscale="log", xlabel="processor time per 30 Hz tick (ms)", ylabel="RMS position error (mm)"
        )
        axes.margins(0.2)
        figure.savefig(file, facecolor="white")


def main() -> None:
    """Measure, print, plot and write metrics."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="two seeds of the main cell, one of timing, no belts")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1, help="local processes")
    options = parser.parse_args()
    quick = options.quick
    results = errors_of("peers", QUICK_SEEDS if quick else None, options.workers)
    spec = results.spec
    times = processor_times(spec, 1 if quick else ROUNDS)
    values: dict[str, float] = {}
    for way, ticks in times.items():
        names = ("tick_mean", "tick_median", "tick_p99")
        for name, own, ours in zip(names, _summary(ticks), _summary(times[spec.baseline_name]), strict=True):
            values[f"{way}.{name}_ms"], values[f"{way}.{name}_ratio"] = own, own / ours
    for cell in results.cells:
        print(f"\n{cell.label}: medians over {len(cell.seeds)} seeds, true frame, kinematic plant")
        print(table(cell, spec.ways, times if cell is results.main else None))
    if not quick:
        belts = errors_of("peers_belts", None, options.workers)
        for cell in belts.cells:
            print(f"\n{cell.label}: medians over {len(cell.seeds)} seeds, true frame, belts")
            print(table(cell, belts.spec.ways, None))
    file = write_metrics("bench_quick" if quick else "bench", values, seed=spec.seeds.first)
    plot(results.main, times, file.parent / "errors_over_time.svg")
    print(file, file.parent / "errors_over_time.svg", sep="\n")
    if quick:
        print("left out: all but two seeds, the pose change, ground of other slip, belts")


if __name__ == "__main__":
    main()
