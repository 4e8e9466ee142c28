from importlib import resources

import pytest
import yaml

from tracked_report.scenario import Scenario, load_scenario
from tracked_types.checked_yaml import CheckedFileError, check_content

EXAMPLE = resources.files("tracked_report") / "data" / "scenario_example.yaml"


def content():
    return yaml.safe_load(EXAMPLE.read_text(encoding="utf-8"))


def check(changed):
    return check_content(Scenario, changed, "scenario.yaml")


def test_packaged_example_loads_and_names_every_key():
    scenario = load_scenario(EXAMPLE, "scenario_example.yaml")
    assert scenario.model_fields_set == set(Scenario.model_fields)
    assert Scenario.model_validate_json(scenario.model_dump_json()) == scenario


def test_variant_parameters_override_those_of_the_scenario():
    changed = content()
    changed["variants"]["double"]["parameters"]["upper_nmpc"] = {"horizon": 12}
    scenario = check(changed)
    assert scenario.parameters_of("single") == {"upper_nmpc": {"horizon": 10}}
    assert scenario.parameters_of("double") == {"upper_nmpc": {"horizon": 12}, "lower_nmpc": {"horizon": 15}}
    with pytest.raises(KeyError):
        scenario.parameters_of("triple")


def test_first_variant_is_the_baseline_unless_one_is_named():
    changed = content()
    assert check(changed | {"baseline": "double"}).baseline_name == "double"
    del changed["baseline"]
    assert check(changed).baseline_name == "single"


def test_variant_suspension_comes_before_that_of_the_scenario():
    changed = content()
    changed["variants"]["single"]["suspension"] = "locked"
    scenario = check(changed)
    assert (scenario.suspension_of("single"), scenario.suspension_of("double")) == ("locked", "qzs")


def test_start_is_a_name_or_a_pose():
    assert check(content() | {"start": "entrance"}).start == "entrance"
    assert check(content()).start.yaw_rad == 0.0


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("name", "Bad Name"),
        ("world", ""),
        ("seed", -1),
        ("duration_s", 0.0),
        ("duration_s", float("nan")),
        ("duration_s", 1e9),
        ("time", "fast"),
        ("pipeline_latency_s", -0.1),
        ("pipeline_latency_s", float("inf")),
        ("suspension", "magic"),
        ("variants", {}),
        ("variants", {"double": {"layers": "triple"}}),
        ("variants", {"Double": {}}),
        ("nodes", {"ekf": "perhaps"}),
        ("baseline", "nobody"),
        ("start", {"x_m": 1.0}),
        ("start", {"x_m": 1.0, "y_m": float("nan")}),
        ("start", "Bad Start"),
        ("reference", {"shape": "line", "file": "a.csv"}),
        ("reference", {"parameters": {}}),
        ("reference", {"shape": "line", "parameters": {"length_m": float("inf")}}),
        ("faults", [{"at_s": 99.0, "kind": "freeze", "target": "tracks"}]),
        ("faults", [{"at_s": 1.0, "kind": "freeze", "target": ""}]),
        ("parameters", {"ekf": {"Gain": 1.0}, "Bad Node": {}}),
        ("speed", 1.0),
    ],
)
def test_bad_value_is_refused_with_its_key(key, value):
    with pytest.raises(CheckedFileError, match=key):
        check(content() | {key: value})


@pytest.mark.parametrize("key", ["name", "world", "duration_s"])
def test_missing_key_is_named(key):
    changed = content()
    del changed[key]
    with pytest.raises(CheckedFileError, match=f"{key}: Field required"):
        check(changed)


def test_missing_file_is_a_clear_error(tmp_path):
    with pytest.raises(CheckedFileError, match="cannot be read"):
        load_scenario(tmp_path / "none.yaml")
