"""The gallery: every entry is a check, on smaller maps and coarser steps than the page's; and the page itself."""

import math
from html.parser import HTMLParser
from pathlib import Path

import pytest

from tracked_lab.gallery.entry import Check, Entry, Label, close, exactly, holds
from tracked_lab.gallery.page import gallery_page
from tracked_lab.gallery.theory import ENTRIES

ERRATA = Path(__file__).parents[4] / "docs" / "errata.md"


@pytest.fixture(scope="module")
def made() -> dict[str, Entry]:
    return {make.__name__: make(True) for make in ENTRIES}


@pytest.mark.parametrize("name", [make.__name__ for make in ENTRIES])
def test_every_check_of_an_entry_holds(name: str, made: dict[str, Entry]) -> None:
    assert made[name].checks
    assert [f"{check.what}: {check.shown}" for check in made[name].checks if not check.passed] == []


def test_the_figures_of_both_chapters_are_there(made: dict[str, Entry]) -> None:
    covered = " ".join(entry.figures for entry in made.values())
    for figure in ("2.1", "2.2", "2.3, 2.4", "2.6, 2.7", "2.8, 2.9", "2.10–2.12", "3.3", "3.4", "3.5–3.8", "3.9–3.11"):
        assert figure in covered
    assert {entry.label for entry in made.values()} == set(Label)


def test_what_is_not_as_printed_names_rows_of_the_errata(made: dict[str, Entry]) -> None:
    rows = ERRATA.read_text(encoding="utf-8")
    for entry in made.values():
        assert entry.errata or entry.label is Label.REPRODUCED
        for row in entry.errata:
            assert f"| {row} |" in rows


class Anchors(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.ids: list[str] = []
        self.links: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name == "id" and value:
                self.ids.append(value)
            if name in ("href", "xlink:href", "src") and value:
                self.links.append(value)


def test_the_page_needs_nothing_else_and_its_links_lead_somewhere(made: dict[str, Entry]) -> None:
    page = gallery_page(list(made.values()), "Figures", "Made anew.", [("commit", "abc")])
    anchors = Anchors()
    anchors.feed(page)
    assert len(set(anchors.ids)) == len(anchors.ids)
    assert all(link.startswith("#") and link[1:] in anchors.ids for link in anchors.links)
    assert "<script" not in page
    assert page.count("<svg") == sum(len(entry.drawings) for entry in made.values())


def test_a_check_that_fails_is_shown_as_failed(made: dict[str, Entry]) -> None:
    bad = Entry("Fig 0", "t", Label.DIFFERS, "text", (exactly("count", 1, 2), holds("true", False)))
    assert not bad.passed
    page = gallery_page([bad], "Figures", "Made anew.", [])
    assert "1 ✗" in page and "no ✗" in page


@pytest.mark.parametrize(
    ("check", "passed", "wanted"),
    [
        (exactly("a", 3, 3), True, "3"),
        (close("a", 1.001, 1.0, 0.01), True, "0.99 to 1.01"),
        (close("a", -1.02, -1.0, 0.01), False, "-1.01 to -0.99"),
        (Check("a", math.nan, 0.0, 1.0), False, "0 to 1"),
        (Check("a", 5.0, 1.0, math.inf), True, "at least 1"),
        (Check("a", 5.0, -math.inf, 1.0), False, "at most 1"),
        (holds("a", True), True, "yes"),
    ],
)
def test_checks_hold_within_their_interval_only(check: Check, passed: bool, wanted: str) -> None:
    assert check.passed is passed
    assert check.wanted == wanted
