"""From records to what a user gets: metrics.json, report.html, the records themselves, a table for the terminal."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from tracked_report.metrics import MetricSettings, MetricSheet, compare_runs
from tracked_report.results import output_folder, write_metrics
from tracked_report.run_record import RunRecord
from tracked_report.whole_file import write_whole


@dataclass(frozen=True, slots=True)
class Published:
    """What was written, and the figures. ``summary``: short table for the terminal."""

    metrics: Path
    report: Path
    records: tuple[Path, ...]
    sheet: MetricSheet
    summary: str


def publish_runs(
    name: str,
    runs: Mapping[str, RunRecord],
    *,
    baseline: str | None = None,
    settings: MetricSettings | None = None,
    out: Path | str | None = None,
) -> Published:
    """Write ``<out>/<name>/{metrics.json, report.html, <variant>.npz}``.

    The baseline of the comparison is the first run unless named. Raises ValueError without any run, OSError where
    nothing can be written.
    """
    # Matplotlib is slow to import: not before there is something to draw.
    from tracked_report.drive_report import drive_report
    from tracked_report.drive_tables import terminal_summary
    from tracked_report.html_report import render_html

    sheet = compare_runs(runs, baseline, settings)
    reference = baseline or next(iter(runs))
    folder = output_folder(out) / name
    records = tuple(record.save(folder / f"{variant}.npz") for variant, record in runs.items())
    metrics = write_metrics(name, sheet.values, seed=next(iter(runs.values())).meta.seed, out=out)
    page = write_whole(folder / "report.html", render_html(drive_report(runs, sheet, reference)))
    return Published(metrics, page, records, sheet, terminal_summary(sheet.values, list(runs), reference))
