"""Figures of chapter 5: every entry is a check on runs of the demo's scenario; slip sampling and command activity."""

from pathlib import Path

import numpy as np
import pytest

from tracked_bringup.node_table import load_node_table
from tracked_bringup.scenarios import load_scenario
from tracked_lab.figures import ENTRIES, drive_figure_runs
from tracked_lab.figures.command_activity import changes, compensation, limit_stretch
from tracked_lab.figures.slip_sampling import MeasuredSlip, held, measured_slip
from tracked_lab.gallery.entry import Entry, Label
from tracked_lab.gallery.page import gallery_page
from tracked_report.channel import Channel
from tracked_report.channels import CHANNELS
from tracked_report.run_record import RunMeta, RunRecord

ERRATA = Path(__file__).parents[4] / "docs" / "errata.md"


@pytest.fixture(scope="module")
def made() -> dict[str, Entry]:
    runs = drive_figure_runs(load_scenario("compare", [], load_node_table()))
    return {make.__name__: make(runs) for make in ENTRIES}


@pytest.mark.parametrize("name", [make.__name__ for make in ENTRIES])
def test_every_check_of_an_entry_holds(name: str, made: dict[str, Entry]) -> None:
    assert [f"{check.what}: {check.shown}" for check in made[name].checks if not check.passed] == []


def test_all_figures_are_there_say_that_they_are_simulated_and_name_rows_of_the_errata(made: dict[str, Entry]) -> None:
    covered = " ".join(entry.figures for entry in made.values())
    assert all(figure in covered for figure in ("5.10", *(f"5.{number}" for number in range(17, 25))))
    rows = ERRATA.read_text(encoding="utf-8")
    for entry in made.values():
        assert entry.text.startswith("Simulated")
        assert entry.errata or entry.label is Label.REPRODUCED
        assert all(f"| {row} |" in rows for row in entry.errata)


def test_every_picture_is_drawn(made: dict[str, Entry]) -> None:
    page = gallery_page(list(made.values()), "Figures", "Made anew.", [])
    assert page.count("<svg") == sum(len(entry.drawings) for entry in made.values())
    assert "Not drawn" not in page


def record(**columns: dict[str, np.ndarray]) -> RunRecord:
    channels = {}
    for name, values in columns.items():
        count = len(next(iter(values.values())))
        rows = np.column_stack([values.get(column, np.zeros(count)) for column in CHANNELS[name].columns])
        step_ns = 200_000_000 if name == "upper_plan" else 20_000_000
        stamps = np.arange(count, dtype=np.int64) * step_ns
        channels[name] = Channel(CHANNELS[name].columns, stamps, rows, np.full(count, np.nan))
    return RunRecord(RunMeta(scenario="made up"), channels)


def test_slower_sampling_knows_the_mean_of_a_period_from_its_end_on() -> None:
    slip = {"yaw_rate_radps": np.array([1.0, 3.0, 5.0, 7.0, 9.0]), "known": np.ones(5)}
    measured = measured_slip(record(slip=slip, tracks={"left_speed_mps": np.full(5, 0.1)}), 2)
    assert measured.slip_radps.tolist() == [2.0, 6.0]
    np.testing.assert_allclose(held(measured, np.array([0.0, 0.02, 0.04, 0.06, 1.0])), [np.nan, 2.0, 2.0, 6.0, 6.0])


def test_one_unknown_sample_makes_the_mean_of_its_period_unknown() -> None:
    slip = {"yaw_rate_radps": np.ones(4), "known": np.array([1.0, 0.0, 1.0, 1.0])}
    measured = measured_slip(record(slip=slip, tracks={"left_speed_mps": np.full(4, 0.1)}), 2)
    np.testing.assert_allclose(measured.slip_radps, [np.nan, 1.0])


@pytest.mark.parametrize(
    ("left", "right", "ratios"),
    [
        (0.2, 0.4, (-0.1, 0.1)),  # the fast track loses, the slow one is dragged along
        (-0.2, 0.4, (0.1, 0.1)),  # against each other both lose
        (0.02, 0.03, (np.nan, np.nan)),
    ],
)
def test_slip_ratios_are_those_of_the_thesis_where_the_belts_run(
    left: float, right: float, ratios: tuple[float, float]
) -> None:
    measured = MeasuredSlip(np.zeros(1), np.array([-0.2]), np.array([left]), np.array([right]))
    np.testing.assert_allclose(np.concatenate(measured.ratios(0.3, 0.1)), ratios, rtol=1e-12)


def test_compensation_finds_what_is_added_to_the_plan_for_the_slip() -> None:
    times = np.arange(100) * 0.02
    lost = 0.1 * np.sin(7.0 * times)
    run = record(
        slip={"yaw_rate_radps": -lost, "known": np.ones(100)},
        cmd_vel={"yaw_rate_radps": 0.3 * times + 1.5 * lost},
        upper_plan={"yaw_rate_radps": 0.3 * np.arange(11) * 0.2},
    )
    assert compensation(run, 0.2, 1.8) == pytest.approx((1.0, 1.5))


def test_commands_are_counted_where_they_change_and_found_at_their_limit() -> None:
    asked = np.array([0.0, 0.0, 0.5, 1.3, 1.3, 1.3, 0.2, 0.2])
    run = record(cmd_vel={"yaw_rate_radps": asked}, cmd_vel_nav={"yaw_rate_radps": asked})
    assert changes(run, 0.0, 1.0) == 3
    assert limit_stretch(run, 0.0, 1.3) == pytest.approx((0.06, 0.12))


@pytest.mark.parametrize("yaw_rates", [[0.0, 0.1, 0.2], [0.0, 1.3, 1.3]])
def test_a_yaw_rate_that_does_not_reach_or_leave_its_limit_is_an_error(yaw_rates: list[float]) -> None:
    run = record(cmd_vel={"yaw_rate_radps": np.array(yaw_rates)})
    with pytest.raises(ValueError, match="no yaw rate is sent"):
        limit_stretch(run, -1.0, 1.3)
