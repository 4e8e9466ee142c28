import dataclasses
import re
from html.parser import HTMLParser

import numpy as np
import pytest

from tracked_report.drive_report import drive_report
from tracked_report.html_report import Cell, Headline, Report, Section, Table, render_html
from tracked_report.metrics import NotRecordedError, compare_runs
from tracked_report.plots.crossings import crossings
from tracked_report.plots.style import Picture
from tracked_report.plots.tracking_plots import transient
from tracked_report.publish import publish_runs
from tracked_report.render import main as render
from tracked_report.run_record import RunMeta, RunRecord
from tracked_report.synthetic import SyntheticSettings, synthetic_pair, synthetic_record

VOID = {"meta", "br", "link", "use", "path", "rect", "img", "circle"}
PICTURES = {"scene", "states", "transient", "errors", "commands", "slip", "ride", "solver", "loops"}


class Balance(HTMLParser):
    """Checks that tags are closed in order, and collects ids."""

    def __init__(self):
        super().__init__()
        self.open, self.ids = [], []

    def handle_starttag(self, tag, attributes):
        self.ids += [value for name, value in attributes if name == "id"]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.ids += [value for name, value in attributes if name == "id"]

    def handle_endtag(self, tag):
        if tag not in VOID:
            assert self.open.pop() == tag


def page_of(runs, baseline=None):
    return render_html(drive_report(runs, compare_runs(runs, baseline), baseline or next(iter(runs))))


@pytest.fixture(scope="module")
def page():
    return page_of(synthetic_pair(duration_s=11.0))


def test_the_page_needs_nothing_from_outside(page):
    assert re.findall(r'(?:src|href)="(?!#)[^"]*"', page) == []
    assert "@import" not in page
    assert "<script" not in page
    assert set(re.findall(r"https?://[^\"' <]+", page)) <= {
        "http://www.w3.org/2000/svg",
        "http://www.w3.org/1999/xlink",
    }


def test_the_page_is_well_formed_and_its_ids_are_unique(page):
    balance = Balance()
    balance.feed(page)
    assert balance.open == []
    assert len(balance.ids) == len(set(balance.ids))
    for target in re.findall(r"url\(#([^)]+)\)", page):
        assert target in balance.ids


def test_every_picture_of_a_full_record_is_drawn(page):
    assert set(re.findall(r'id="([a-z]+)-figure_1"', page)) == PICTURES
    assert "Not drawn" not in page


def test_an_empty_record_still_makes_a_page_that_says_what_is_missing():
    page = page_of({"single": RunRecord(RunMeta(scenario="empty")), "double": RunRecord(RunMeta(scenario="empty"))})
    assert page.count("Not drawn") == len(PICTURES - {"transient"})
    assert "no solver times were recorded" in page
    assert "no reference was recorded" in page


@pytest.mark.parametrize("channel", ["truth", "reference", "odometry", "cmd_vel"])
def test_a_missing_channel_costs_only_its_own_pictures(channel):
    record = synthetic_record(SyntheticSettings(duration_s=5.0))
    less = dataclasses.replace(record, channels={k: v for k, v in record.channels.items() if k != channel})
    page = page_of({"double": less})
    assert page.count("Not drawn") <= 3
    assert "From above" in page


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e308])
def test_bad_numbers_in_every_channel_do_not_break_the_page(bad):
    record = synthetic_record(SyntheticSettings(duration_s=5.0))
    channels = {}
    for name, channel in record.channels.items():
        values = channel.values.copy()
        values[::9] = bad
        channels[name] = dataclasses.replace(channel, values=values)
    assert "<svg" in page_of({"double": dataclasses.replace(record, channels=channels)})


def test_one_run_alone_makes_a_page_without_comparison():
    page = page_of({"double": synthetic_record(SyntheticSettings(duration_s=5.0))})
    assert "against double" not in page
    assert "% less" not in page


def test_text_is_escaped():
    hostile = "<script>alert('x')</script> & \"quotes\""
    table = Table(["a"], [[Cell(hostile, "bad")]], hostile)
    pictures = [Picture("p", hostile, hostile, missing=hostile)]
    report = Report(
        hostile,
        hostile,
        [(hostile, hostile)],
        [Headline(hostile, hostile)],
        [Section(hostile, hostile, [table, *pictures])],
    )
    page = render_html(dataclasses.replace(report, missing=[(hostile, hostile)]))
    assert "<script" not in page
    assert "&lt;script&gt;" in page


def test_crossings_are_the_stretches_over_the_step():
    kinds = {kind: (start, end) for start, end, kind in crossings(synthetic_record())}
    assert kinds["step"] == pytest.approx((2.0 / 0.3, 2.6 / 0.3), abs=0.5)
    assert "wall" not in kinds


def test_a_sudden_change_of_the_pose_is_a_crossing_and_what_the_transient_shows():
    record = synthetic_record(SyntheticSettings(duration_s=5.0))
    pushed = dataclasses.replace(record, meta=record.meta.model_copy(update={"disturbed_s": (2.0, 2.6)}))
    start_s = record.channel("reference").stamps_ns[0] * 1e-9
    assert ("forced", 2.0 - start_s, 2.6 - start_s) in [
        (kind, pytest.approx(start), pytest.approx(end)) for start, end, kind in crossings(pushed)
    ]
    with pytest.raises(NotRecordedError, match="no step was crossed"):
        transient({"run": record}, "transient")
    assert "turned by force" in transient({"run": pushed}, "transient")


@pytest.fixture(scope="module")
def published(tmp_path_factory):
    return publish_runs("demo", synthetic_pair(duration_s=5.0), out=tmp_path_factory.mktemp("out"))


def test_publishing_writes_page_figures_and_records(published):
    names = sorted(path.name for path in published.report.parent.iterdir())
    assert names == ["double.npz", "metrics.json", "report.html", "single.npz"]
    assert "RMS heading (rad)" in published.summary
    assert "% less" in published.summary


def test_rendering_saved_records_gives_the_same_page(published):
    out = published.report.parents[1]
    assert render([*map(str, published.records), "--name", "again", "--out", str(out)]) == 0
    assert (out / "again" / "report.html").read_text() == published.report.read_text()


def test_rendering_a_damaged_record_is_one_clear_line(tmp_path, capsys):
    (tmp_path / "run.npz").write_bytes(b"broken")
    assert render([str(tmp_path / "run.npz"), "--out", str(tmp_path)]) == 1
    assert "not a readable run record" in capsys.readouterr().err
