"""The thesis's figures of chapters 2 and 3 made anew, each an executable check: ``make gallery``."""

from collections.abc import Callable

from tracked_lab.gallery.chua_figures import limit_cycle, printed_theorem, stabilisation, synchronisation
from tracked_lab.gallery.entry import Entry
from tracked_lab.gallery.filter_figures import (
    fast_disturbance,
    frequency_response,
    indices,
    poles,
    slow_disturbance,
)
from tracked_lab.gallery.map_figures import large_box, responses, small_box

ENTRIES: tuple[Callable[[bool], Entry], ...] = (
    small_box,
    large_box,
    responses,
    limit_cycle,
    printed_theorem,
    stabilisation,
    synchronisation,
    poles,
    frequency_response,
    fast_disturbance,
    slow_disturbance,
    indices,
)
"""Makers of entries in the order of the thesis; with True they take smaller grids and coarser steps."""
