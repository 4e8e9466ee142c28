"""Variants of a scenario side by side, as in Table 5.1."""

from collections.abc import Mapping

from tracked_report.metrics.sheet import MetricSheet

_REDUCED = ("ptop", "rms", "max")


def reduction_percent(baseline: float, candidate: float) -> float:
    """How much smaller ``candidate`` is, in per cent of ``baseline``; NaN if the baseline is zero."""
    return 100.0 * (1.0 - candidate / baseline) if baseline else float("nan")


def reduction_key(key: str) -> str | None:
    """``estimated.rms_x_m`` -> ``estimated.rms_reduction_x_percent``; None for figures that have no reduction."""
    group, dot, figure = key.rpartition(".")
    kind, _, rest = figure.partition("_")
    if not dot or kind not in _REDUCED or "_" not in rest or group not in ("estimated", "true"):
        return None
    return f"{group}.{kind}_reduction_{rest.rpartition('_')[0]}_percent"


def reductions(baseline: Mapping[str, float], candidate: Mapping[str, float]) -> MetricSheet:
    """Reductions of all tracking figures that both variants have."""
    sheet = MetricSheet()
    for key, value in baseline.items():
        name = reduction_key(key)
        if name is not None and key in candidate:
            sheet.put(name, reduction_percent(value, candidate[key]), "the baseline's figure is zero")
    return sheet
