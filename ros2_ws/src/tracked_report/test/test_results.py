import json
import math

import numpy as np
import pytest

from tracked_report.results import MetricsError, read_metrics, write_metrics


def test_the_file_has_exactly_the_agreed_fields(tmp_path):
    path = write_metrics("demo", {"double.rms_y_m": np.float64(0.019), "count": 3}, seed=7, out=tmp_path)
    content = json.loads(path.read_text())
    assert path == tmp_path / "demo" / "metrics.json"
    assert list(content) == ["name", "commit", "seed", "created", "machine", "values"]
    assert content["values"] == {"double.rms_y_m": 0.019, "count": 3.0}
    assert {"cpu", "cores", "python"} <= set(content["machine"])


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, None, "fast"])
def test_a_figure_that_is_no_finite_number_is_refused_by_name_and_nothing_is_written(tmp_path, value):
    with pytest.raises(MetricsError, match=r"solver\.p99_ms"):
        write_metrics("solver", {"solver.median_ms": 1.0, "solver.p99_ms": value}, out=tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_figure_that_may_be_missing_becomes_null(tmp_path):
    path = write_metrics("demo", {"settling_s": math.nan}, out=tmp_path, allow_missing=["settling_s"])
    assert read_metrics(path).values == {"settling_s": None}


@pytest.mark.parametrize("key", ["", "Upper", "a..b", "a b", ".a", "a-b"])
def test_malformed_keys_are_refused(tmp_path, key):
    with pytest.raises(MetricsError, match="must be lower-case words"):
        write_metrics("demo", {key: 1.0}, out=tmp_path)


@pytest.mark.parametrize("name", ["", "../demo", "a/b"])
def test_a_name_that_leaves_the_output_folder_is_refused(tmp_path, name):
    with pytest.raises(MetricsError, match="plain folder name"):
        write_metrics(name, {}, out=tmp_path)


def test_a_failed_write_leaves_the_old_file_and_no_litter(tmp_path, monkeypatch):
    path = write_metrics("demo", {"a": 1.0}, out=tmp_path)
    monkeypatch.setattr("os.replace", lambda *_: (_ for _ in ()).throw(OSError("disk full")))
    with pytest.raises(OSError, match="disk full"):
        write_metrics("demo", {"a": 2.0}, out=tmp_path)
    assert read_metrics(path).values == {"a": 1.0}
    assert [entry.name for entry in path.parent.iterdir()] == ["metrics.json"]


def test_the_environment_moves_the_output_folder(tmp_path, monkeypatch):
    monkeypatch.setenv("TRACKED_OUT", str(tmp_path / "elsewhere"))
    assert write_metrics("demo", {}) == tmp_path / "elsewhere" / "demo" / "metrics.json"


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("", "is not JSON"),
        ("[]", "has no 'values'"),
        ('{"values": {"a": "b"}}', "a is not a number"),
        ("{", "is not JSON"),
    ],
)
def test_damaged_files_are_clear_errors(tmp_path, content, reason):
    path = tmp_path / "metrics.json"
    path.write_text(content)
    with pytest.raises(MetricsError, match=reason):
        read_metrics(path)
