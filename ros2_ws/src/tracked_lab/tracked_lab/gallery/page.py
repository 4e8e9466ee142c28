"""The gallery as one page that needs nothing else: no network, no scripts."""

from collections import Counter
from collections.abc import Sequence

from tracked_lab.gallery.entry import Check, Entry, Label
from tracked_report.html_report import Cell, Headline, Report, Section, Table, Tone, render_html

_TONE: dict[Label, Tone] = {Label.REPRODUCED: "good", Label.CORRECTED: "plain", Label.DIFFERS: "bad"}


def gallery_page(entries: Sequence[Entry], title: str, subtitle: str, facts: Sequence[tuple[str, str]]) -> str:
    """The page's HTML; ``facts`` are told under the title."""
    return render_html(
        Report(
            title,
            subtitle,
            facts=[*facts, ("errata", "docs/errata.md")],
            headlines=_headlines(entries),
            sections=[_overview(entries), *(_section(entry) for entry in entries)],
        )
    )


def _headlines(entries: Sequence[Entry]) -> list[Headline]:
    count = Counter(entry.label for entry in entries)
    checks = [check for entry in entries for check in entry.checks]
    good = sum(check.passed for check in checks)
    notes = {
        Label.REPRODUCED: "as printed",
        Label.CORRECTED: "with an error removed",
        Label.DIFFERS: "what is printed does not hold",
    }
    figures = [Headline(str(count[label]), label.value, notes[label], _TONE[label]) for label in Label]
    every: Tone = "good" if good == len(checks) else "bad"
    return [*figures, Headline(f"{good} of {len(checks)}", "checks hold", "measured when this page was made", every)]


def _overview(entries: Sequence[Entry]) -> Section:
    rows: list[list[Cell | str]] = [
        [
            Cell(_unbroken(entry.figures), anchor=entry.slug),
            entry.title,
            Cell(_unbroken(entry.label.value), _TONE[entry.label]),
            Cell(entry.headline, "plain" if entry.passed else "bad"),
        ]
        for entry in entries
    ]
    return Section("Overview", items=[Table(["figure", "what", "stands", "found"], rows, numeric=False)])


def _unbroken(text: str) -> str:
    return text.replace(" ", "\u00a0")


def _section(entry: Entry) -> Section:
    text = entry.text + (f" (errata {', '.join(entry.errata)})" if entry.errata else "")
    rows: list[list[Cell | str]] = [[check.what, check.thesis, _found(check), check.wanted] for check in entry.checks]
    table = Table(["", "thesis", "found", "must be"], rows)
    return Section(
        f"{entry.figures}: {entry.title}",
        text,
        [*(drawn.picture(f"{entry.slug}-{number}") for number, drawn in enumerate(entry.drawings)), table],
        badge=Cell(entry.label.value, _TONE[entry.label]),
        anchor=entry.slug,
    )


def _found(check: Check) -> Cell:
    return Cell(f"{check.shown} {'✓' if check.passed else '✗'}", "good" if check.passed else "bad")
