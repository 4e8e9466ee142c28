import json
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis.extra import numpy as hnp

from tracked_report.channel import Channel
from tracked_report.run_record import Event, RunMeta, RunRecord, RunRecordError
from tracked_report.synthetic import SyntheticSettings, synthetic_record


def same(first, second):
    assert first.meta == second.meta
    assert first.events == second.events
    assert list(first.channels) == list(second.channels)
    for name, channel in first.channels.items():
        other = second.channels[name]
        assert channel.columns == other.columns
        np.testing.assert_array_equal(channel.stamps_ns, other.stamps_ns)
        np.testing.assert_array_equal(channel.values, other.values)
        np.testing.assert_array_equal(channel.arrivals_s, other.arrivals_s)


def rewrite(path, **changes):
    with np.load(path) as archive:
        arrays = {name: archive[name] for name in archive.files}
    arrays.update(changes)
    np.savez(path, **{name: value for name, value in arrays.items() if value is not None})


@pytest.fixture
def saved(tmp_path):
    return synthetic_record(SyntheticSettings(duration_s=4.0)).save(tmp_path / "run.npz")


def test_a_record_comes_back_bit_for_bit(tmp_path):
    record = synthetic_record(SyntheticSettings(duration_s=4.0))
    same(record, RunRecord.load(record.save(tmp_path / "deep" / "run.npz")))


@settings(max_examples=30, deadline=None)
@given(hnp.arrays(np.float64, hnp.array_shapes(min_dims=2, max_dims=2, min_side=0, max_side=6)))
def test_any_numbers_survive_the_round_trip(values):
    columns = tuple(f"c{index}" for index in range(values.shape[1]))
    channel = Channel(columns, np.arange(len(values), dtype=np.int64), values, np.zeros(len(values)))
    record = RunRecord(RunMeta(scenario="s"), {"odd": channel}, (Event(stamp_ns=1, source="é", text="ü"),))
    with tempfile.TemporaryDirectory() as folder:
        same(record, RunRecord.load(record.save(Path(folder) / "run.npz")))


def test_a_channel_not_recorded_is_empty_and_an_unknown_one_an_error():
    record = RunRecord(RunMeta(scenario="s"))
    assert len(record.channel("truth")) == 0
    assert "x_m" in record.channel("truth").columns
    with pytest.raises(KeyError, match="no channel 'trooth'"):
        record.channel("trooth")


def test_a_file_cut_short_is_a_clear_error(saved):
    saved.write_bytes(saved.read_bytes()[:-2000])
    with pytest.raises(RunRecordError, match=r"run\.npz"):
        RunRecord.load(saved)


@pytest.mark.parametrize("content", [b"", b"not an archive", b"PK\x03\x04 broken"])
def test_a_file_that_is_no_record_is_a_clear_error(tmp_path, content):
    path = tmp_path / "run.npz"
    path.write_bytes(content)
    with pytest.raises(RunRecordError, match="not a readable run record"):
        RunRecord.load(path)


def test_a_missing_file_is_a_clear_error(tmp_path):
    with pytest.raises(RunRecordError, match="not a readable run record"):
        RunRecord.load(tmp_path / "none.npz")


def test_a_plain_array_is_no_record(tmp_path):
    np.save(tmp_path / "run.npy", np.zeros(3))
    with pytest.raises(RunRecordError, match="not a readable run record"):
        RunRecord.load(tmp_path / "run.npy")


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"truth/values": np.zeros((3, 2))}, "channel truth"),
        ({"truth/stamps_ns": np.zeros(3)}, "whole nanoseconds"),
        ({"truth/values": np.array(["x"])}, "could not convert"),
        ({"truth/values": None}, "truth/values"),
        ({"header": np.array("{")}, "header|JSON"),
        ({"header": np.array(json.dumps({"format": 1, "columns": {}}))}, "meta"),
        ({"header": np.array(json.dumps({"format": 2, "columns": {}, "meta": {"scenario": "s"}}))}, "newer"),
        ({"header": None}, "header"),
    ],
)
def test_an_inconsistent_record_says_what_is_wrong(saved, changes, reason):
    rewrite(saved, **changes)
    with pytest.raises(RunRecordError, match=reason):
        RunRecord.load(saved)


def test_a_failed_save_leaves_the_old_record(saved, monkeypatch):
    before = saved.read_bytes()
    monkeypatch.setattr("os.replace", lambda *_: (_ for _ in ()).throw(OSError("disk full")))
    with pytest.raises(OSError, match="disk full"):
        synthetic_record(SyntheticSettings(duration_s=2.0)).save(saved)
    assert saved.read_bytes() == before
    assert [path.name for path in saved.parent.iterdir()] == [saved.name]
