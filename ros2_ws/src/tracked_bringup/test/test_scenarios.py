from importlib import import_module
from pathlib import Path

import pytest

from tracked_bringup.graph_plan import plan_graph
from tracked_bringup.node_table import load_node_table
from tracked_bringup.scenarios import ArgumentError, load_scenario, scenario_names, split_change
from tracked_types.checked_yaml import CheckedFileError

TABLE = load_node_table()
ROS_OWN = {"use_sim_time"}


def test_the_promised_scenarios_are_there() -> None:
    assert {"compare", "track", "idle", "map"} <= set(scenario_names())


@pytest.mark.parametrize("name", scenario_names())
def test_every_parameter_that_a_packaged_scenario_sets_is_one_of_its_node(name: str) -> None:
    scenario = load_scenario(name, [], TABLE)
    for variant in scenario.variants:
        for node in plan_graph(TABLE, scenario, variant, namespace="r1").nodes:
            module, _, class_name = node.entry.node_class.partition(":")
            known = getattr(import_module(module), class_name).PARAMETERS
            for parameter, value in node.parameters.items():
                if parameter in ROS_OWN or parameter == "frame_prefix":
                    continue
                assert parameter in known, f"{node.name}.{parameter}"
                known[parameter].checked(value)


def test_the_demo_compares_one_layer_with_two_at_the_thesis_latency() -> None:
    scenario = load_scenario("compare", [], TABLE)
    assert scenario.name == "demo" and scenario.world == "step" and scenario.pipeline_latency_s == 0.1
    assert [variant.layers for variant in scenario.variants.values()] == ["single", "double"]
    assert scenario.baseline_name == "single" and scenario.time == "lock_step"


def test_changes_reach_the_scenario_and_the_nodes() -> None:
    changes = ["duration_s:=7", "reference.shape:=circle", "reference.parameters.radius_m:=0.8", "ekf.some:=1.5"]
    scenario = load_scenario("track", changes, TABLE)
    assert scenario.duration_s == 7.0
    assert scenario.reference is not None and scenario.reference.shape == "circle"
    assert scenario.reference.parameters["radius_m"] == 0.8
    assert scenario.parameters["ekf"] == {"some": 1.5}


def test_files_that_are_not_there_are_taken_from_the_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    changes = ["map_server.map:=maps/rooms.yaml"]
    scenario = load_scenario("map", changes, TABLE)
    assert scenario.reference is not None and scenario.reference.file is not None
    assert Path(scenario.reference.file).is_file() and Path(str(scenario.parameters["map_server"]["map"])).is_file()
    (tmp_path / "maps").mkdir()
    (tmp_path / "maps" / "rooms.yaml").touch()
    assert load_scenario("map", changes, TABLE).parameters["map_server"]["map"] == "maps/rooms.yaml"
    missing = load_scenario("map", ["map_server.map:=none.yaml"], TABLE)
    assert missing.parameters["map_server"]["map"] == "none.yaml"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("duration_s", "expected key:=value"),
        (":=3", "expected key:=value"),
        ("seed:=[1", "seed: .* is not a value"),
        ("duration:=3", "did you mean duration_s"),
        ("efk.x:=3", "did you mean ekf"),
        ("ekf:=3", "given as ekf.PARAMETER"),
        ("ekf.a.b:=3", "given as ekf.PARAMETER"),
        ("world.x:=3", "world has no keys"),
    ],
)
def test_a_change_that_means_nothing_is_refused(change: str, words: str) -> None:
    with pytest.raises(ArgumentError, match=words):
        load_scenario("track", [change], TABLE)


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ("duration_s:=-1", "duration_s"),
        ("time:=warped", "time"),
        ("nodes.radio:=true", "nodes.radio"),
        ("seed:=x", "seed"),
    ],
)
def test_a_change_to_an_impossible_value_is_refused_by_key(change: str, key: str) -> None:
    with pytest.raises(CheckedFileError, match=key):
        load_scenario("track", [change], TABLE)


def test_an_unknown_scenario_is_refused_with_the_known_ones() -> None:
    with pytest.raises(ArgumentError, match=r"no scenario 'trakc'; there are .*track"):
        load_scenario("trakc", [], TABLE)


def test_a_scenario_file_is_found_by_path(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text("name: mine\nworld: flat\nduration_s: 3.0\n")
    assert load_scenario(str(path), [], TABLE).name == "mine"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "expected keys"),
        ("[", "not a YAML file"),
        ("name: mine\nworld: flat\nduration_s: 3\nparameters: {radio: {x: 1}}", r"parameters\.radio: no such node"),
        (
            "name: mine\nworld: flat\nduration_s: 3\nvariants: {one: {parameters: {radio: {x: 1}}}}",
            r"variants\.one\.parameters\.radio: no such node",
        ),
    ],
)
def test_a_malformed_scenario_file_is_refused_by_name(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    with pytest.raises(CheckedFileError, match=rf"mine\.yaml: .*{words}"):
        load_scenario(str(path), [], TABLE)


def test_a_missing_scenario_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(CheckedFileError, match="cannot be read"):
        load_scenario(str(tmp_path / "missing.yaml"), [], TABLE)


@pytest.mark.parametrize(
    ("text", "value"),
    [("a:=1", 1), ("a:=1.5", 1.5), ("a:=true", True), ("a:=[1, 2]", [1, 2]), ("a:=", None), ("a:=b:=c", "b:=c")],
)
def test_values_are_read_as_yaml(text: str, value: object) -> None:
    assert split_change(text) == ("a", value)
