"""Figures 5.10 and 5.17 to 5.24 made anew, each from runs of the belt world: ``make figures-5``."""

from collections.abc import Callable

from tracked_lab.figures.disturbed import disturbed_commands, disturbed_errors, disturbed_states
from tracked_lab.figures.figure_runs import FigureRuns, drive_figure_runs
from tracked_lab.figures.slip_rates import slip_at_rates
from tracked_lab.figures.undisturbed import commands, errors, states
from tracked_lab.gallery.entry import Entry

ENTRIES: tuple[Callable[[FigureRuns], Entry], ...] = (
    slip_at_rates,
    states,
    errors,
    commands,
    disturbed_states,
    disturbed_errors,
    disturbed_commands,
)
"""Makers of entries in the order of the thesis."""

__all__ = ["ENTRIES", "FigureRuns", "drive_figure_runs"]
