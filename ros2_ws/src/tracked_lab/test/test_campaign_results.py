import numpy as np
import pytest

from tracked_lab.campaign.campaign_report import publish_campaign
from tracked_lab.campaign.results import gather
from tracked_lab.campaign.run_store import StoredRun
from tracked_lab.campaign.spec import CampaignSpec
from tracked_report.results import read_metrics

SPEC = CampaignSpec.model_validate(
    {
        "name": "c",
        "scenario": {"name": "s", "world": "flat", "duration_s": 1.0, "reference": {"shape": "line"}},
        "ways": ["single", "double"],
        "seeds": {"first": 5, "count": 4},
        "axes": {"pose": {"odometry": {}, "lidar": {"conditions.pose": "lidar"}}},
        "main": {"pose": "lidar"},
    }
)
RECOVERIES_S = {5: 0.4, 6: 0.6, 7: 0.5}  # seed 8 never recovered


def stored(change=lambda planned, values: ("ok", values)):
    found = {}
    for planned in SPEC.runs():
        seed, double = planned.scenario.seed, planned.way == "double"
        values = {"true.rms_x_m": 0.01 * seed * (0.25 if double else 1.0)}
        if seed in RECOVERIES_S:
            values["true.recovery_s"] = RECOVERIES_S[seed]
        status, values = change(planned, values)
        found[planned.key] = StoredRun(
            planned.key, "c", planned.way, seed, planned.cell, planned.model_dump_json(), status, "no", values,
            commit="abc", created=f"2026-01-0{seed - 4}T00:00:00+00:00",
        )  # fmt: skip
    return found


def test_reductions_are_medians_of_pairs_in_every_cell():
    figures = gather(SPEC, stored()).figures()
    for cell in ("odometry", "lidar"):
        assert figures[f"{cell}.double.true.rms_x_lower_percent"] == pytest.approx(75.0)
        assert figures[f"{cell}.single.true.rms_x_m"] == pytest.approx(0.065)
    assert figures["runs"] == figures["planned"] == 16 and figures["failed"] == 0


def test_a_run_that_never_recovered_counts_in_the_median_and_in_the_share():
    figures = gather(SPEC, stored()).figures()
    assert figures["lidar.double.true.recovery_s"] == pytest.approx(0.55)  # of 0.4, 0.5, 0.6 and never
    assert figures["lidar.double.true.recovery_share"] == pytest.approx(0.75)


def test_where_most_runs_never_recovered_there_is_no_time_but_a_share():
    def rarely(planned, values):
        return "ok", {name: value for name, value in values.items() if planned.scenario.seed == 5 or "rms" in name}

    figures = gather(SPEC, stored(rarely)).figures()
    assert "lidar.double.true.recovery_s" not in figures
    assert figures["lidar.double.true.recovery_share"] == pytest.approx(0.25)


def test_failed_runs_are_counted_and_leave_their_pair_out():
    def fails(planned, values):
        return ("failed", {}) if planned.scenario.seed == 6 and planned.way == "single" else ("ok", values)

    results = gather(SPEC, stored(fails))
    assert len(results.failed) == 2 and results.figures()["failed"] == 2
    assert results.main.reduction("double", "true.rms_x_m", "single").count == 3
    assert np.isnan(results.main.values["single"]["true.rms_x_m"][1])


def test_a_campaign_that_is_not_done_says_how_many_seeds_are_whole():
    rows = {key: run for key, run in stored().items() if run.seed < 7 or run.cell["pose"] == "lidar"}
    figures = gather(SPEC, rows).figures()
    assert (figures["odometry.whole_seeds"], figures["lidar.whole_seeds"]) == (2, 4)
    assert figures["least_whole_seeds"] == 2
    one_way = {key: run for key, run in rows.items() if run.way == "single"}
    assert gather(SPEC, one_way).figures()["lidar.whole_seeds"] == 0


def test_a_store_without_the_campaign_says_so():
    with pytest.raises(ValueError, match="no run of campaign c"):
        gather(SPEC, {})


def test_page_and_figures_say_when_the_runs_were_made_and_what_failed(tmp_path, monkeypatch):
    def fails(planned, values):
        return ("timeout", {}) if planned.scenario.seed == 7 and planned.way == "double" else ("ok", values)

    monkeypatch.setenv("TRACKED_OUT", str(tmp_path))
    rows = stored(fails)
    metrics, page = publish_campaign(gather(SPEC, rows))
    assert read_metrics(metrics).values["failed"] == 2.0
    text = page.read_text()
    assert "made 2026-01-01T00:00:00+00:00 to 2026-01-04" in text and "by commit abc" in text
    assert "double, seed 7" in text and "<script src" not in text
    assert len((metrics.parent / "runs.csv").read_text().splitlines()) == 17
