"""One look for every picture, and figures as inline SVG."""

import io
import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure

INK = "#1f2933"
MUTED = "#7b8794"
REFERENCE = "#1f2933"
TRUTH = "#009e73"
LIMIT = "#9aa5b1"
# Okabe and Ito's colours, told apart by colour-blind readers; the first is the baseline's.
_VARIANTS = ("#d55e00", "#0072b2", "#cc79a7", "#e69f00", "#56b4e9", "#117733")
_SETTINGS: Any = {
    "svg.fonttype": "none",
    "svg.hashsalt": "tracked_report",
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 9.0,
    "axes.titlesize": 9.5,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.titlecolor": INK,
    "axes.edgecolor": "#9aa5b1",
    "axes.labelcolor": INK,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.xmargin": 0.01,
    "grid.color": "#e4e7eb",
    "grid.linewidth": 0.8,
    "text.color": INK,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "lines.linewidth": 1.3,
    "lines.solid_capstyle": "round",
    "legend.frameon": False,
    "figure.facecolor": "none",
    "axes.facecolor": "none",
}


@dataclass(frozen=True, slots=True)
class Picture:
    """One picture of a report: SVG text, or the reason why it could not be drawn."""

    slug: str
    title: str
    caption: str
    svg: str = ""
    missing: str = ""


def new_figure(width_in: float, height_in: float) -> Figure:
    """An empty figure in the common style (apply `styled` around everything that draws)."""
    return Figure(figsize=(width_in, height_in), layout="constrained")


def styled() -> Any:
    """Context in which the common style holds."""
    return matplotlib.rc_context(_SETTINGS)


def variant_colour(index: int) -> str:
    """Colour of the variant at this place; the baseline comes first."""
    return _VARIANTS[index % len(_VARIANTS)]


def legend_above(figure: Figure, axes: Iterable[Axes]) -> None:
    """One legend for the whole figure, above it, each label once."""
    entries: dict[str, Any] = {}
    for ax in axes:
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, handle)
    if entries:
        columns = min(len(entries), 6)
        figure.legend(list(entries.values()), list(entries), loc="outside upper left", ncols=columns, borderaxespad=0.2)


def to_svg(figure: Figure, slug: str, description: str) -> str:
    """Inline SVG: scales with the page, ids unique to ``slug``, text as text, coordinates to 0.01 pt."""
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    text = buffer.getvalue()
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>", "", text, flags=re.DOTALL)
    text = re.sub(r'\bid="', f'id="{slug}-', text)
    text = re.sub(r"url\(#", f"url(#{slug}-", text)
    text = re.sub(r'href="#', f'href="#{slug}-', text)
    text = re.sub(r' d="[^"]*"', lambda match: re.sub(r"(\.\d\d)\d+", r"\1", match.group()), text)
    text = re.sub(r'(<svg[^>]*?) (?:width|height)="[^"]*"', r"\1", text)
    text = re.sub(r'(<svg[^>]*?) (?:width|height)="[^"]*"', r"\1", text)
    label = description.replace("&", "&amp;").replace('"', "&quot;").replace("<", "&lt;")
    return text.replace("<svg", f'<svg role="img" aria-label="{label}"', 1).strip()
