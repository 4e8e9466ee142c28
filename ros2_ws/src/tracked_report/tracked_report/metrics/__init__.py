"""Figures of runs: tracking errors (5.3.1)-(5.3.2), commands, slip, ride, solver and loop times."""

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from tracked_report.metrics.commands import command_metrics
from tracked_report.metrics.comparison import reductions
from tracked_report.metrics.ride import ride_metrics
from tracked_report.metrics.settings import MetricSettings
from tracked_report.metrics.sheet import MetricSheet, NotRecordedError
from tracked_report.metrics.slip import slip_metrics
from tracked_report.metrics.timing import LAYERS, latency_metrics, loop_metrics, solver_metrics
from tracked_report.metrics.tracking import FRAMES, tracking_metrics
from tracked_report.run_record import RunRecord

__all__ = ["MetricSettings", "MetricSheet", "NotRecordedError", "compare_runs", "run_metrics"]

_LOOPS = {"upper": "upper_status", "lower": "lower_status", "command": "cmd_vel"}
_WORST_OF_VARIANTS = ("slip.speed_rms_mps", "slip.yaw_rate_rms_radps")


def run_metrics(record: RunRecord, settings: MetricSettings | None = None) -> MetricSheet:
    """Every figure that can be made from one record, and the reason for those that cannot.

    Groups of keys: ``estimated``, ``true``, ``command``, ``slip``, ``ride``, ``solver``, ``loop``, ``latency``.
    """
    chosen = settings or MetricSettings()
    jobs: list[tuple[str, str, Callable[[], MetricSheet]]] = [
        *((frame, "", partial(tracking_metrics, record, frame, chosen)) for frame in FRAMES),
        ("command", "", partial(command_metrics, record)),
        ("slip", "", partial(slip_metrics, record)),
        ("ride", "", partial(ride_metrics, record, chosen)),
        *(("solver", layer, partial(solver_metrics, record, layer)) for layer in LAYERS),
        *(("loop", name, partial(loop_metrics, record, channel, name)) for name, channel in _LOOPS.items()),
        ("latency", "", partial(latency_metrics, record)),
    ]
    sheet = MetricSheet()
    for group, part, job in jobs:
        try:
            # A figure that overflows is missing, not a warning.
            with np.errstate(over="ignore", invalid="ignore"):
                sheet.update(job(), group)
        except NotRecordedError as error:
            sheet.missing[f"{group}.{part}" if part else group] = str(error)
    return sheet


def compare_runs(
    runs: Mapping[str, RunRecord], baseline: str | None = None, settings: MetricSettings | None = None
) -> MetricSheet:
    """Figures of all variants (``double.estimated.rms_x_m``) and their reductions against the baseline.

    With two variants reductions are keyed ``estimated.rms_reduction_x_percent``; with more, behind the name of
    the variant. ``slip.*`` without a variant is the worst of all. The baseline is the first variant unless named.

    Raises ValueError if there is no run or the baseline is not among them.
    """
    if not runs:
        raise ValueError("no run to make figures of")
    reference = next(iter(runs)) if baseline is None else baseline
    if reference not in runs:
        raise ValueError(f"baseline {reference!r} is not among the runs {', '.join(runs)}")
    sheets = {name: run_metrics(record, settings) for name, record in runs.items()}
    total = MetricSheet()
    for name, sheet in sheets.items():
        total.update(sheet, name)
        if name != reference:
            total.update(reductions(sheets[reference].values, sheet.values), "" if len(runs) == 2 else name)
    for key in _WORST_OF_VARIANTS:
        figures = [sheet.values[key] for sheet in sheets.values() if key in sheet.values]
        if figures:
            total.put(key, max(figures))
    return total
