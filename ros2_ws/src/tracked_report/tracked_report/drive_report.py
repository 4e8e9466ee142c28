"""The report of a drive: variants side by side, the way the thesis shows them (Figs 5.16-5.24, Table 5.1)."""

from collections.abc import Callable, Mapping

import numpy as np

from tracked_report.drive_tables import channel_table, coverage_warning, other_table, reduction_text, tracking_table
from tracked_report.html_report import Headline, Report, Section, Table, Tone
from tracked_report.metrics import MetricSheet, NotRecordedError
from tracked_report.plots import signal_plots, timing_plots, tracking_plots
from tracked_report.plots.style import Picture, styled
from tracked_report.run_record import RunRecord

Runs = Mapping[str, RunRecord]
Draw = Callable[[Runs, str], str]

_SCENE: tuple[str, str, str, Draw] = (
    "scene",
    "From above",
    "World frame. The true path of each variant over the reference; odometry drifts, so the robot may follow its "
    "estimate well and still end beside the goal.",
    tracking_plots.scene,
)
_TRACKING: tuple[tuple[str, str, str, Draw], ...] = (
    (
        "states",
        "States",
        "As Figs 5.17 and 5.18: reference, estimate and truth, in the odom frame.",
        tracking_plots.states,
    ),
    (
        "transient",
        "Pushed off the way",
        "As Fig 5.22 (b): the estimates of all runs while the step, or force, pushes the robot off its way, and just "
        "after.",
        tracking_plots.transient,
    ),
    (
        "errors",
        "Tracking errors",
        "As Figs 5.19 and 5.23: reference minus pose. Left what the controller sees, right what is true; the "
        "difference is the drift of the odometry, which no controller removes.",
        tracking_plots.errors,
    ),
)
_SIGNALS: tuple[tuple[str, str, str, Draw], ...] = (
    (
        "commands",
        "Commands",
        "As Figs 5.20 and 5.24: commands sent to the base (solid) and the first input of each plan of the upper "
        "layer (dashed); dotted, the limits.",
        signal_plots.commands,
    ),
    (
        "slip",
        "Slip",
        "What the ground adds to the motion that the belts ask for. Gaps: standstill, where the belts bear no witness. "
        "Of the speed only the part that comes with turning is estimated: slip that both belts share cannot be seen "
        "from belts and gyro.",
        signal_plots.slip,
    ),
    (
        "ride",
        "Vertical acceleration",
        "As Fig 5.16: world vertical of the body, gravity removed, through a 50 Hz low-pass where the samples are "
        "dense enough for one.",
        signal_plots.ride,
    ),
)
_TIMING: tuple[tuple[str, str, str, Draw], ...] = (
    (
        "solver",
        "Solver times",
        "Share of ticks that took at most so long, thread CPU time with the call; dotted, half and 99 % of the ticks.",
        timing_plots.solver_times,
    ),
    (
        "loops",
        "Loop periods and latency",
        "On the wall clock. In lock-step the world waits for the controllers: periods scale with the real-time factor.",
        timing_plots.loop_periods,
    ),
)


def drive_report(runs: Runs, sheet: MetricSheet, baseline: str) -> Report:
    """Compose the report of the runs; pictures and figures that cannot be made say why.

    Parameters
    ----------
    runs: variant -> record, at least one. sheet: figures as `metrics.compare_runs` gives them.
    """
    first = next(iter(runs.values())).meta
    variants = list(runs)
    tables = [tracking_table(sheet.values, variants, baseline, frame) for frame in ("estimated", "true")]
    sections = [
        Section("The run", _variants_text(runs), [draw(runs, _SCENE)]),
        Section(
            "Tracking",
            "Peak to peak (5.3.1) and root mean square (5.3.2) of the tracking error, as in Table 5.1, from the first "
            "reference point until one second after the reference has come to rest. "
            + coverage_warning(sheet.values, variants),
            [*tables, *(draw(runs, job) for job in _TRACKING if job[0] != "transient" or _pushed(runs))],
        ),
        Section("Commands, slip and ride", items=[draw(runs, job) for job in _SIGNALS]),
        Section("Timing", items=[draw(runs, job) for job in _TIMING]),
        Section("Other figures", items=[other_table(sheet.values, variants)]),
        Section("Where it was made", items=[_provenance(runs)]),
        Section("Events", items=[_events(runs)], folded=True),
        Section("All figures", items=[_all_figures(sheet)], folded=True),
        Section("Channels", items=[channel_table(runs)], folded=True),
    ]
    return Report(
        title=f"Scenario {first.scenario}",
        subtitle=first.description,
        facts=_facts(runs),
        headlines=_headlines(sheet, variants, baseline),
        sections=sections,
        missing=tuple(sorted(sheet.missing.items())),
    )


def draw(runs: Runs, job: tuple[str, str, str, Draw]) -> Picture:
    """One picture in the common style, or the reason why it cannot be drawn."""
    slug, title, caption, function = job
    try:
        with styled(), np.errstate(over="ignore", invalid="ignore"):
            return Picture(slug, title, caption, svg=function(runs, slug))
    except NotRecordedError as error:
        return Picture(slug, title, caption, missing=str(error))


def _pushed(runs: Runs) -> bool:
    metas = [record.meta for record in runs.values()]
    return any(meta.disturbed_s or any(outline.kind == "step" for outline in meta.scene) for meta in metas)


def _variants_text(runs: Runs) -> str:
    """What each variant is, in one sentence each."""
    told = {name: record.meta.variant_description for name, record in runs.items()}
    return " ".join(f"{name}: {text.rstrip('.')}." for name, text in told.items() if text)


def _facts(runs: Runs) -> list[tuple[str, str]]:
    meta = next(iter(runs.values())).meta
    facts = [
        ("world", meta.world),
        ("seed", "" if meta.seed is None else str(meta.seed)),
        ("time", meta.time.replace("_", "-")),
        ("upper pipeline latency", "" if meta.pipeline_latency_s is None else f"{meta.pipeline_latency_s:g} s"),
        ("suspension", ", ".join(dict.fromkeys(record.meta.suspension for record in runs.values()))),
        ("commit", meta.commit),
        ("made", meta.created[:16].replace("T", " ") + " UTC" if meta.created.endswith("+00:00") else meta.created),
    ]
    return [(label, value) for label, value in facts if value]


def _headlines(sheet: MetricSheet, variants: list[str], baseline: str) -> list[Headline]:
    lines = []
    others = [name for name in variants if name != baseline]
    if others:
        for axis, label in (("x", "x"), ("y", "y"), ("theta", "heading")):
            key = f"estimated.rms_reduction_{axis}_percent"
            percent = sheet.values.get(key if len(variants) == 2 else f"{others[-1]}.{key}")
            if percent is not None:
                note = f"{others[-1]} against {baseline}, estimated frame"
                tone: Tone = "good" if percent > 0.0 else "bad"
                lines.append(Headline(reduction_text(percent), f"RMS {label} error", note, tone))
    slip = sheet.values.get("slip.yaw_rate_rms_radps")
    if slip is not None:
        lines.append(Headline(f"{slip:.4f} rad/s", "slip yaw rate, RMS error", "estimate against truth, worst run"))
    return lines


def _provenance(runs: Runs) -> Table:
    meta = next(iter(runs.values())).meta
    rows = [[key.replace("_", " "), str(value)] for key, value in meta.machine.items()]
    rows += [[name, version] for name, version in meta.versions.items()]
    for name, record in runs.items():
        if record.meta.wall_duration_s is not None:
            rows.append([f"wall time, {name}", f"{record.meta.wall_duration_s:.1f} s"])
        rows += [[f"{key.replace('_', ' ')}, {name}", str(value)] for key, value in record.meta.notes.items()]
    return Table(["what", "value"], rows, numeric=False)


def _events(runs: Runs) -> Table:
    rows = [
        [name, f"{event.stamp_ns * 1e-9:.3f}", event.source, event.text]
        for name, record in runs.items()
        for event in record.events
    ]
    return Table(["variant", "stamp (s)", "source", "event"], rows or [["–", "–", "–", "none recorded"]], numeric=False)


def _all_figures(sheet: MetricSheet) -> Table:
    return Table(["key", "value"], [[key, f"{value:.6g}"] for key, value in sorted(sheet.values.items())])
