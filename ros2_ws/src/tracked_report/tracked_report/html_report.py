"""Self-contained HTML report: no network, no fonts, no scripts; knows nothing of what it reports on."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from importlib import resources
from typing import Literal

from jinja2 import Environment, FunctionLoader, StrictUndefined
from markupsafe import Markup

from tracked_report.plots.style import Picture

Tone = Literal["good", "bad", "plain"]


@dataclass(frozen=True, slots=True)
class Cell:
    """One cell of a table: text, whether it is good or bad news, and the anchor of a section that it leads to."""

    text: str
    tone: Tone = "plain"
    anchor: str = ""


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of cells (or plain text) under headers; the first column names the row, the others are numbers."""

    headers: Sequence[str]
    rows: Sequence[Sequence[Cell | str]]
    caption: str = ""
    numeric: bool = True

    def cells(self) -> list[list[Cell]]:
        """The rows with every cell as a Cell."""
        return [[cell if isinstance(cell, Cell) else Cell(cell) for cell in row] for row in self.rows]


@dataclass(frozen=True, slots=True)
class Headline:
    """One figure in large print at the top."""

    value: str
    label: str
    note: str = ""
    tone: Tone = "plain"


@dataclass(frozen=True, slots=True)
class Section:
    """A titled part with text, pictures and tables in order; ``folded`` sections open on demand.

    ``badge`` stands beside the title; ``anchor`` is what cells lead to.
    """

    title: str
    text: str = ""
    items: Sequence[Picture | Table] = ()
    folded: bool = False
    badge: Cell | None = None
    anchor: str = ""


@dataclass(frozen=True, slots=True)
class Report:
    """Everything the page shows. ``missing``: what could not be made, and why."""

    title: str
    subtitle: str = ""
    facts: Sequence[tuple[str, str]] = ()
    headlines: Sequence[Headline] = ()
    sections: Sequence[Section] = ()
    missing: Sequence[tuple[str, str]] = field(default_factory=tuple)


def render_html(report: Report) -> str:
    """The page, one HTML text with style and pictures inside; every text is escaped but the pictures' SVG."""
    environment = Environment(
        loader=FunctionLoader(_template),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["svg"] = lambda picture: Markup(picture.svg)
    environment.tests["table"] = lambda item: isinstance(item, Table)
    return environment.get_template("report.html.j2").render(report=report)


def _template(name: str) -> str:
    return (resources.files("tracked_report") / "templates" / name).read_text(encoding="utf-8")
