"""Plain tables for a terminal."""

import os
import re
import sys
from collections.abc import Sequence
from typing import Literal, TextIO

Align = Literal["left", "right"]
_COLOURS = {"green": "32", "red": "31", "yellow": "33", "bold": "1", "dim": "2"}
_ESCAPE = re.compile(r"\x1b\[[0-9;]*m")


def render_table(
    rows: Sequence[Sequence[str]], headers: Sequence[str] = (), align: Sequence[Align] = (), indent: str = ""
) -> str:
    """Columns padded to their widest cell, two spaces apart, a rule under the headers; no trailing newline.

    Columns without an entry in ``align`` are left-aligned; rows may be shorter than the widest.
    """
    table = [list(headers), *map(list, rows)] if headers else [list(row) for row in rows]
    if not table:
        return ""
    count = max(len(row) for row in table)
    table = [row + [""] * (count - len(row)) for row in table]
    widths = [max(visible_length(row[column]) for row in table) for column in range(count)]
    sides = [*align, *["left"] * (count - len(align))]
    lines = [indent + "  ".join(map(_pad, row, widths, sides)).rstrip() for row in table]
    if headers:
        lines.insert(1, indent + "  ".join("-" * width for width in widths))
    return "\n".join(lines)


def visible_length(text: str) -> int:
    """Length of a text without colour codes."""
    return len(_ESCAPE.sub("", text))


def coloured(text: str, colour: str, stream: TextIO = sys.stdout) -> str:
    """The text in a colour (green, red, yellow, bold, dim) where ``stream`` is a terminal that wants colours."""
    if not stream.isatty() or os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb":
        return text
    return f"\x1b[{_COLOURS[colour]}m{text}\x1b[0m"


def _pad(text: str, width: int, side: str) -> str:
    gap = " " * (width - visible_length(text))
    return gap + text if side == "right" else text + gap
