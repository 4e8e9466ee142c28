import json
import textwrap

import pytest
import yaml

from tracked_report.claims import BAD_LEDGER, HOLDS, MISSED, NOT_MEASURED, main

WRITER = """
import json, os, pathlib, sys
folder = pathlib.Path(os.environ.get("TRACKED_OUT", "out")) / "bench"
folder.mkdir(parents=True, exist_ok=True)
(folder / "metrics.json").write_text('{"name": "bench", "commit": "abc", "values": VALUES}')
with open("runs.txt", "a") as log:
    log.write(" ".join(sys.argv[1:]) + "|")
"""


def claim(identity="p.a", **changes):
    row = {
        "id": identity,
        "statement": "s",
        "direction": "at_most",
        "target": 1.0,
        "unit": "ms",
        "from": "bench",
        "key": "a",
    }
    return row | changes


@pytest.fixture
def project(tmp_path):
    def build(claims, script=WRITER, values='{"a": 0.5, "b": 2.0, "c": null, "d": NaN}', **measurement):
        (tmp_path / "claims").mkdir(exist_ok=True)
        (tmp_path / "bench.py").write_text(textwrap.dedent(script).replace("VALUES", values))
        bench = {"run": "python bench.py", "metrics": "out/bench/metrics.json"} | measurement
        ledger = {"part": "p", "measurements": {"bench": bench}, "claims": claims}
        (tmp_path / "claims" / "p.yaml").write_text(yaml.safe_dump(ledger))
        return tmp_path

    return build


def run(root, *arguments):
    return main(["--root", str(root), *arguments])


def written(root, where="out"):
    return json.loads((root / where / "claims.json").read_text())


def test_claims_that_hold_pass_and_one_command_serves_them_all(project, capsys):
    root = project(
        [claim(), claim("p.b", direction="at_least", key="b"), claim("p.c", direction="within", target=[0, 1])]
    )
    assert run(root) == HOLDS
    assert (root / "runs.txt").read_text() == "|"
    entry = {"value": 0.5, "target": 1.0, "unit": "ms", "ok": True, "commit": "abc", "command": "python bench.py"}
    assert written(root)["p.a"] == entry
    assert "3 of 3 claims hold" in capsys.readouterr().out


def test_a_missed_claim_is_said_in_plain_sight(project, capsys):
    root = project([claim(), claim("p.b", key="b")])
    assert run(root) == MISSED
    assert written(root)["p.b"]["ok"] is False
    line = next(line for line in capsys.readouterr().out.splitlines() if "p.b" in line)
    assert line.split() == ["MISS", "p.b", "<=", "1", "ms", "2", "-1"]


@pytest.mark.parametrize(
    ("key", "reason"), [("z", "have no z"), ("c", "c is not a finite"), ("d", "d is not a finite")]
)
def test_a_figure_that_is_not_there_is_a_miss_with_its_reason(project, capsys, key, reason):
    root = project([claim(), claim("p.b", key=key)])
    assert run(root) == NOT_MEASURED
    assert written(root)["p.a"]["ok"] is True
    assert written(root)["p.b"] | {"ok": False, "value": None} == written(root)["p.b"]
    assert reason in written(root)["p.b"]["reason"]
    assert reason in capsys.readouterr().out


@pytest.mark.parametrize(
    ("script", "reason"),
    [
        ("print('no luck'); raise SystemExit(3)", "exit code 3: no luck"),
        ("pass", "wrote no new out/bench/metrics.json"),
        (WRITER.replace("'{", "'["), "not JSON"),
    ],
)
def test_a_command_that_fails_misses_its_claims_with_the_reason(project, script, reason):
    root = project([claim()], script=script)
    assert run(root) == NOT_MEASURED
    assert reason in written(root)["p.a"]["reason"]


def test_figures_left_from_an_earlier_run_are_not_taken_for_fresh_ones(project):
    root = project([claim()])
    assert run(root) == HOLDS
    (root / "bench.py").write_text("pass")
    assert run(root) == NOT_MEASURED
    assert "wrote no new" in written(root)["p.a"]["reason"]


def test_a_command_that_does_not_exist_or_hangs_is_told(project):
    assert run(project([claim()], run="no_such_program")) == NOT_MEASURED
    root = project([claim()], script="import signal; signal.pause()", timeout_s=0.2)
    assert run(root) == NOT_MEASURED
    assert "ran longer than 0.2 s" in written(root)["p.a"]["reason"]


def test_quick_runs_only_quick_claims_and_leaves_the_full_figures_alone(project, capsys):
    root = project([claim(quick=True), claim("p.b", key="b")], quick="python bench.py --quick")
    assert run(root, "--quick") == HOLDS
    assert (root / "runs.txt").read_text() == "--quick|"
    assert list(written(root, "out/quick")) == ["p.a"]
    assert not (root / "out" / "claims.json").exists()
    assert "PASS" in capsys.readouterr().out


def test_the_run_itself_can_be_claimed(project):
    root = project([claim(), claim("p.b", **{"from": "self"}, key="claims.minutes")])
    assert run(root) == HOLDS
    assert 0.0 < written(root)["p.b"]["value"] < 1.0


def test_entries_of_other_parts_stay_and_those_of_dropped_claims_go(project):
    root = project([claim(), claim("p.b", key="b", direction="at_least")])
    other = {"part": "q", "measurements": {}, "claims": []}
    (root / "claims" / "q.yaml").write_text(yaml.safe_dump(other))
    assert run(root, "--part", "p") == HOLDS
    project([claim()])
    assert run(root) == HOLDS
    assert list(written(root)) == ["p.a"]


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"direction": "below"}, "direction"),
        ({"target": float("nan")}, "target"),
        ({"direction": "within"}, "within"),
        ({"direction": "within", "target": [2.0, 1.0]}, "low must not exceed high"),
        ({"target": [1.0, 2.0]}, "within"),
        ({"from": "nothing"}, "nothing"),
        ({"id": "q.a"}, "must start with p"),
        ({"quick": True}, "no quick command"),
        ({"kee": "a"}, "kee"),
    ],
)
def test_a_bad_ledger_is_refused_with_the_row(project, capsys, changes, reason):
    assert run(project([claim() | changes])) == BAD_LEDGER
    assert reason in capsys.readouterr().err


def test_ids_must_differ(project, capsys):
    assert run(project([claim(), claim()])) == BAD_LEDGER
    assert "p.a appears twice" in capsys.readouterr().err


def test_an_unknown_part_lists_the_known_ones(project, capsys):
    assert run(project([claim()]), "--part", "z") == BAD_LEDGER
    assert "parts there: p" in capsys.readouterr().err
