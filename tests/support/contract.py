"""The contract between the nodes, read from docs/topics.md."""

from dataclasses import dataclass
from importlib import import_module

from tests.support.node_process import ROOT
from tracked_bringup.node_table import load_node_table

PAGE = ROOT / "docs" / "topics.md"
EVERY_NODE = "every node"
"""In the place of names: all of the node table that take part without being named."""
ONLOOKERS = frozenset({"recorder", "mcap_recorder", "replay", "bringup"})


@dataclass(frozen=True, slots=True)
class Row:
    """One topic.

    publishers: exactly these nodes (recorder and bringup left out everywhere). subscribers: at least these.
    rate_hz: stamps are the instants of this grid, none left out; None: on events. frame: of the header, may be "".
    latched: transient local, for those who come late.
    """

    topic: str
    type: type
    publishers: frozenset[str]
    subscribers: frozenset[str]
    rate_hz: int | None
    frame: str
    latched: bool


def read_contract() -> tuple[Row, ...]:
    """Every row of the table."""
    lines = [line for line in PAGE.read_text().splitlines() if line.startswith("| `")]
    return tuple(_row([cell.strip() for cell in line.strip("|").split("|")]) for line in lines)


def _row(cells: list[str]) -> Row:
    topic, kind, rate, publishers, subscribers, frame, note = cells
    package, name = kind.split("/")
    return Row(
        topic=topic.strip("`"),
        type=getattr(import_module(f"{package}.msg"), name),
        publishers=_names(publishers),
        subscribers=_names(subscribers),
        rate_hz=None if rate == "event" else int(rate),
        frame=frame,
        latched=note == "latched",
    )


def _names(cell: str) -> frozenset[str]:
    if cell == EVERY_NODE:
        return frozenset(name for name, entry in load_node_table().nodes.items() if not entry.optional) - ONLOOKERS
    return frozenset(name.strip() for name in cell.split(",") if name.strip())


CONTRACT = read_contract()
