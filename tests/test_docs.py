"""Pages that are made from the code are those that the code makes."""

import re

from tests.support.node_process import ROOT
from tools.node_pages import PAGE, page


def test_the_page_of_nodes_is_up_to_date():
    assert PAGE.read_text(encoding="utf-8") == page(), "run `make docs` and commit docs/nodes.md"


def test_pages_link_to_what_there_is():
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").glob("*.md"), ROOT / "docker" / "README.md"]
    for source in pages:
        for target in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", source.read_text(encoding="utf-8")):
            if "://" not in target:
                assert (source.parent / target).exists(), f"{source.name} links to {target}"


def test_every_erratum_that_code_or_pages_cite_is_a_row():
    rows = set(re.findall(r"^\| (\S+)[ |]", (ROOT / "docs" / "errata.md").read_text(encoding="utf-8"), re.MULTILINE))
    sources = [
        *(ROOT / "ros2_ws" / "src").rglob("*.py"),
        *(ROOT / "benchmarks").glob("*.py"),
        *(ROOT / "docs").glob("*.md"),
    ]
    cited = {
        (row, source.name)
        for source in sources
        for row in re.findall(r"\berratum (\d[\w.-]*\w)", source.read_text(encoding="utf-8"))
    }
    assert len(rows) > 20 and cited
    assert {(row, source) for row, source in cited if row not in rows} == set()
