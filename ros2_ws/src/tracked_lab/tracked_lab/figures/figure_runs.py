"""The runs that the figures of chapter 5 are made from."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from tracked_description import load_robot
from tracked_lab.conditions import Conditions
from tracked_lab.lock_step import drive
from tracked_lab.table_variants import TABLE_VARIANTS
from tracked_report.drive_report import draw
from tracked_report.metrics import run_metrics
from tracked_report.plots.style import Picture
from tracked_report.plots.timeline import origin_ns
from tracked_report.run_record import RunRecord
from tracked_report.scenario import Scenario
from tracked_types import to_nanoseconds

Runs = Mapping[str, RunRecord]
_PRINTED = "double_as_printed"
_SHOWN_S = 24.0
"""How much of a run pictures show; later on nothing moves."""


@dataclass(frozen=True, slots=True)
class FigureRuns:
    """One run of the belt world per way to drive, all on the same seed.

    single, double, printed: undisturbed; pushed_single, pushed_double: with the sudden change of the pose of 5.3.2.
    gauge_m: distance of the tracks.
    """

    single: RunRecord
    printed: RunRecord
    double: RunRecord
    pushed_single: RunRecord
    pushed_double: RunRecord
    gauge_m: float

    @property
    def undisturbed(self) -> Runs:
        """Single and double layer by the names that pictures give them."""
        return {"single layer": self.single, "double layer": self.double}

    @property
    def pushed(self) -> Runs:
        """The same with the sudden change of the pose."""
        return {"single layer": self.pushed_single, "double layer": self.pushed_double}


def drive_figure_runs(scenario: Scenario) -> FigureRuns:
    """Drive the scenario's variants ``single`` and ``double``, and the double layer as printed.

    Raises
    ------
    KeyError: if the scenario lacks one of the two variants.
    """
    variants = {**scenario.variants, _PRINTED: TABLE_VARIANTS[_PRINTED].variant}
    scenario = scenario.model_copy(update={"variants": variants})
    robot = load_robot(scenario.robot)
    pushed = Conditions(obstacle=True)
    return FigureRuns(
        single=drive(scenario, "single", robot),
        printed=drive(scenario, _PRINTED, robot),
        double=drive(scenario, "double", robot),
        pushed_single=drive(scenario, "single", robot, conditions=pushed),
        pushed_double=drive(scenario, "double", robot, conditions=pushed),
        gauge_m=robot.tracks.gauge_m,
    )


def figures_of(record: RunRecord) -> dict[str, float]:
    """Every figure of one run; one that could not be made is missing."""
    return dict(run_metrics(record).values)


@dataclass(frozen=True, slots=True)
class RunDrawing:
    """A picture of `tracked_report.plots` of some runs."""

    title: str
    caption: str
    runs: Runs
    plot: Callable[[Runs, str], str]

    def picture(self, slug: str) -> Picture:
        """The picture, or the reason why it cannot be drawn."""
        runs = {name: _begin_of(record) for name, record in self.runs.items()}
        return draw(runs, (slug, self.title, self.caption, self.plot))


def _begin_of(record: RunRecord) -> RunRecord:
    begin = origin_ns(record)
    end = begin + to_nanoseconds(_SHOWN_S)
    return replace(record, channels={name: rows.between(begin, end) for name, rows in record.channels.items()})
