"""The page of a campaign: the main cell in large, every cell in tables, intervals as pictures."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from tracked_lab.campaign.results import TRACKING, CampaignResults, CellResults, rows_of
from tracked_lab.campaign.run_store import StoredRun
from tracked_report.html_report import Cell, Headline, Report, Section, Table, Tone, render_html
from tracked_report.plots.style import Picture, legend_above, new_figure, styled, to_svg, variant_colour
from tracked_report.results import output_folder, write_metrics
from tracked_report.whole_file import write_whole

_TITLES = {
    "rms_x_m": "RMS x",
    "rms_y_m": "RMS y",
    "rms_theta_rad": "RMS heading",
    "ptop_x_m": "PtoP x",
    "ptop_y_m": "PtoP y",
    "ptop_theta_rad": "PtoP heading",
}


def publish_campaign(results: CampaignResults, name: str | None = None) -> tuple[Path, Path]:
    """Write ``out/<name>/{metrics.json, report.html, runs.csv}``; paths of the first two."""
    name = name or results.spec.name
    values = results.figures()
    metrics = write_metrics(name, values, seed=results.spec.seeds.first)
    folder = output_folder() / name
    write_whole(folder / "runs.csv", _csv(results.runs))
    return metrics, write_whole(folder / "report.html", render_html(_report(results)))


def _csv(runs: Sequence[StoredRun]) -> str:
    rows = rows_of(runs)
    columns = list(dict.fromkeys(column for row in rows for column in row))
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def _report(results: CampaignResults) -> Report:
    spec, main = results.spec, results.main
    baseline = spec.baseline_name
    best = [way for way in spec.ways if way != baseline]
    headlines = []
    for way in best[:4]:
        lower = main.reduction(way, "true.rms_x_m", baseline)
        turn = main.reduction(way, "true.rms_theta_rad", baseline)
        if lower is not None and turn is not None:
            label = f"{way}: RMS x, heading against {baseline}"
            headlines.append(Headline(f"{-lower.median:+.0f} %, {-turn.median:+.0f} %", label))
    sections = [_main_section(results), *[_cell_section(results, cell) for cell in results.cells]]
    facts = [
        ("runs", f"{len(results.runs)} of {results.planned}"),
        ("seeds", f"{spec.seeds.first} to {spec.seeds.values()[-1]}"),
        ("without figures", str(len(results.failed))),
        ("results", results.filled),
        ("reference covered", _covered(results)),
    ]
    problems = [(f"{run.way}, seed {run.seed}", f"{run.status}: {_last_line(run.error)}") for run in results.failed]
    return Report(f"Campaign {spec.name}", spec.description, facts, headlines[:3], sections, problems)


def _covered(results: CampaignResults) -> str:
    middle = results.main.median(results.spec.baseline_name, "true.covered_percent")
    return "unknown" if middle is None else f"{middle.median:.0f} % of its time, from the start on"


def _seeds(cell: CellResults) -> str:
    return f"{cell.whole_seeds} of {len(cell.seeds)} seeds"


def _main_section(results: CampaignResults) -> Section:
    main = results.main
    words = ", ".join(f"{axis} {label}" for axis, label in main.cell) or "all runs"
    text = (
        f"{words}. Each dot is the median over {_seeds(main)} of how much lower an error is than that of "
        f"{results.spec.baseline_name} on the same seed, with its 95 % bootstrap interval; true frame. Simulated."
    )
    return Section("Against the baseline", text, [_intervals(results, main)])


def _intervals(results: CampaignResults, cell: CellResults) -> Picture:
    ways = [way for way in results.spec.ways if way != results.spec.baseline_name]
    with styled():
        figure = new_figure(8.0, 3.6)
        axes = figure.subplots()
        for index, way in enumerate(ways):
            for place, metric in enumerate(TRACKING):
                lower = cell.reduction(way, f"true.{metric}", results.spec.baseline_name)
                if lower is None:
                    continue
                at = place + 0.8 * ((index + 0.5) / len(ways) - 0.5)
                colour = variant_colour(index + 1)
                axes.plot([at, at], [lower.low, lower.high], color=colour, linewidth=2.0)
                axes.plot([at], [lower.median], "o", color=colour, markersize=4.0, label=way)
        axes.set_xticks(np.arange(len(TRACKING)), [_TITLES[metric] for metric in TRACKING])
        axes.set_ylabel(f"lower than {results.spec.baseline_name} (%)")
        axes.axhline(0.0, color="#9aa5b1", linewidth=0.8)
        axes.set_ylim(bottom=max(axes.get_ylim()[0], -150.0))
        legend_above(figure, [axes])
        return Picture("reductions", "Errors against the baseline", "", to_svg(figure, "reductions", "reductions"))


def _cell_section(results: CampaignResults, cell: CellResults) -> Section:
    title = ", ".join(f"{axis} {label}" for axis, label in cell.cell) or "all runs"
    folded = cell is not results.main
    return Section(
        title, f"{_seeds(cell)}.", [_table(results, cell, frame) for frame in ("true", "estimated")], folded=folded
    )


def _table(results: CampaignResults, cell: CellResults, frame: str) -> Table:
    baseline = results.spec.baseline_name
    rows = []
    for way in results.spec.ways:
        row: list[Cell | str] = [way]
        for metric in TRACKING:
            middle = cell.median(way, f"{frame}.{metric}")
            if middle is None:
                row.append("-")
                continue
            unit, scale = ("mm", 1e3) if metric.endswith("_m") else ("mrad", 1e3)
            lower = cell.reduction(way, f"{frame}.{metric}", baseline) if way != baseline else None
            text = f"{scale * middle.median:.1f} {unit}"
            if lower is None:
                row.append(text)
            else:
                tone: Tone = "good" if lower.low > 0.0 else "bad" if lower.high < 0.0 else "plain"
                row.append(Cell(f"{text} ({-lower.median:+.0f} %)", tone))
        rows.append(row)
    headers = ["way to drive", *[_TITLES[metric] for metric in TRACKING]]
    return Table(headers, rows, f"{frame} frame: median error, and its median change against {baseline}")


def _last_line(text: str) -> str:
    lines = text.strip().splitlines()
    return lines[-1] if lines else ""
