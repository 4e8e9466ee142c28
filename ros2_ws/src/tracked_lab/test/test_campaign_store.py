import json
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tracked_lab.campaign import run_store
from tracked_lab.campaign.run_store import RunStore, StoredRun, StoreError


def stored(key="a", status="ok", value=1.0):
    return StoredRun(key, "c", "single", 1, {"pose": "lidar"}, "{}", status, "", {"true.rms_x_m": value}, 0.1, 0.1)


def test_what_was_added_is_there_once_by_its_key(tmp_path):
    store = RunStore(tmp_path / "store")
    store.add([stored("a", value=1.0), stored("b", value=2.0)])
    store.add([stored("a", value=3.0)])
    assert {key: run.values["true.rms_x_m"] for key, run in RunStore(store.folder).runs().items()} == {
        "a": 1.0,
        "b": 2.0,
    }
    assert store.runs()["a"] == stored("a")


def test_a_run_that_failed_gives_way_to_one_that_did_not(tmp_path):
    store = RunStore(tmp_path)
    store.add([stored("a", "failed")])
    store.add([stored("a", "ok")])
    store.add([stored("a", "timeout")])
    assert store.runs()["a"].ok


@settings(max_examples=20, deadline=None)
@given(st.lists(st.lists(st.integers(0, 30), max_size=5), max_size=30))
def test_compaction_loses_and_doubles_nothing(tmp_path_factory, batches):
    store = RunStore(tmp_path_factory.mktemp("store"))
    for batch in batches:
        store.add([stored(str(number), value=float(number)) for number in batch])
    before = store.runs()
    store.compact()
    assert store.runs() == before and len(list(store.folder.glob("part-*"))) == 1


def test_parts_do_not_pile_up_and_large_ones_are_left_alone(tmp_path, monkeypatch):
    monkeypatch.setattr(run_store, "_MOST_PARTS", 5)
    monkeypatch.setattr(run_store, "_LARGE_ROWS", 8)
    store = RunStore(tmp_path)
    for number in range(23):
        store.add([stored(str(number))])
    parts = list(tmp_path.glob("part-*"))
    assert len(store.runs()) == 23 and len(parts) <= 8


def test_a_part_cut_short_by_a_killed_process_is_never_seen(tmp_path):
    store = RunStore(tmp_path)
    store.add([stored("a")])
    (tmp_path / ".part-0.parquet.1.tmp").write_bytes(b"half")
    assert list(store.runs()) == ["a"]


def test_a_full_disk_is_one_sentence_and_what_was_there_stays(tmp_path, monkeypatch):
    store = RunStore(tmp_path)
    store.add([stored("a")])

    def full(_path, _content):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(run_store, "write_whole", full)
    with pytest.raises(StoreError, match="the disk is full"):
        store.add([stored("b")])
    assert list(store.runs()) == ["a"]


def test_a_store_of_another_version_is_refused(tmp_path):
    RunStore(tmp_path)
    (tmp_path / "format.json").write_text(json.dumps({"format": 99}))
    with pytest.raises(StoreError, match="format 99"):
        RunStore(tmp_path)


def test_a_folder_of_other_parquet_files_or_a_damaged_part_is_named(tmp_path):
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "x.parquet").write_bytes(b"1")
    with pytest.raises(StoreError, match="no campaign wrote"):
        RunStore(tmp_path / "other")
    store = RunStore(tmp_path / "store")
    (store.folder / "part-bad.parquet").write_bytes(b"nonsense")
    with pytest.raises(StoreError, match=r"part-bad\.parquet"):
        store.runs()


def test_a_place_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(StoreError, match="cannot be used"):
        RunStore(tmp_path / "file" / "store")


def test_what_failed_keeps_its_traceback(tmp_path):
    store = RunStore(tmp_path)
    store.add([replace(stored("a", "failed"), error="Traceback ...\nValueError: no")])
    assert "ValueError: no" in store.runs()["a"].error
