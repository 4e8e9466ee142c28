"""Parameter tables: types, ranges, YAML and documentation."""

from dataclasses import dataclass

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from node_kit import BadParameterError, Parameter, ParameterTable
from node_kit.docs import render_nodes
from tracked_types.setting import check_settings, setting


@dataclass(frozen=True, slots=True, kw_only=True)
class FilterSettings:
    gauge_m: float
    gain: float = setting(1.5, "Gain of the loop.", unit="1/s", low=0.0, high=5.0)
    mode: str = setting("soft", "How it stops", choices=("soft", "hard"))
    count: int = setting(3, "Number of tries", low=1)
    enabled: bool = setting(True, "Whether it works at all")

    def __post_init__(self) -> None:
        check_settings(self)


TABLE = ParameterTable.from_settings(
    FilterSettings, extra=(Parameter("sources", ("nav", "teleop"), "Who may command"),), live=("gain",)
)


def test_only_tunable_fields_become_parameters():
    assert [parameter.name for parameter in TABLE] == ["gain", "mode", "count", "enabled", "sources"]
    assert [parameter.name for parameter in TABLE if parameter.live] == ["gain"]


def test_checked_values_make_the_settings_again():
    values = TABLE.checked({"gain": 2, "mode": "hard"})
    values.pop("sources")
    made = FilterSettings(gauge_m=0.3, **values)
    assert (made.gain, made.mode, made.count) == (2.0, "hard", 3)
    assert type(made.gain) is float


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("gain", -0.1, "gain must be at least 0 1/s"),
        ("gain", 5.1, "gain must be at most 5 1/s"),
        ("gain", float("nan"), "gain must be finite"),
        ("gain", "1.0", "gain must be of type float"),
        ("gain", True, "gain must be of type float"),
        ("count", 1.0, "count must be of type int"),
        ("count", 0, "count must be at least 1"),
        ("mode", "rigid", "mode must be one of soft, hard"),
        ("enabled", 1, "enabled must be of type bool"),
        ("sources", "nav", "sources must be a list of str"),
        ("sources", ["nav", 1], "sources must be of type str"),
        ("sources", None, "sources must be a list of str"),
    ],
)
def test_bad_value_is_refused_with_name_and_expectation(name, value, reason):
    with pytest.raises(BadParameterError, match=reason):
        TABLE.checked({name: value})


def test_all_problems_are_named_at_once():
    with pytest.raises(BadParameterError, match=r"gain.*; .*mode"):
        TABLE.checked({"gain": -1.0, "mode": "x"})


SCALARS = st.none() | st.booleans() | st.integers() | st.floats() | st.text()


@given(st.dictionaries(st.sampled_from([parameter.name for parameter in TABLE]), SCALARS | st.lists(SCALARS)))
def test_any_values_are_checked_or_refused(values):
    try:
        checked = TABLE.checked(values)
    except BadParameterError:
        return
    assert TABLE.checked(checked) == checked


def test_unknown_name_is_answered_with_the_nearest():
    assert TABLE.unknown(["gian", "mode", "zzz"]) == [
        "parameter gian is unknown (did you mean gain?)",
        "parameter zzz is unknown",
    ]


def test_yaml_holds_every_value_under_the_node_name():
    content = yaml.safe_load(TABLE.to_yaml("ekf", {"gain": 2.0}))
    assert content == {
        "ekf": {
            "ros__parameters": {
                "gain": 2.0,
                "mode": "soft",
                "count": 3,
                "enabled": True,
                "sources": ["nav", "teleop"],
            }
        }
    }


def test_yaml_of_an_empty_table_is_a_parameter_file():
    assert yaml.safe_load(ParameterTable().to_yaml()) == {"/**": {"ros__parameters": {}}}


def test_markdown_has_a_row_per_parameter_with_limits_and_choices():
    rows = TABLE.to_markdown().splitlines()
    assert len(rows) == 2 + len(TABLE)
    assert "| `gain` | float | `1.5` | 1/s | 0 to 5 | Gain of the loop; can be changed while the node runs |" in rows
    assert "| `mode` | str | `soft` |  | soft, hard | How it stops |" in rows
    assert "| `count` | int | `3` |  | at least 1 | Number of tries |" in rows
    assert "| `sources` | list of str | `[nav, teleop]` |  |  | Who may command |" in rows


def test_page_of_nodes_has_a_section_each():
    class Filter:
        """Estimates things."""

        NAME = "filter"
        PARAMETERS = TABLE

    class Plain:
        NAME = "plain"
        PARAMETERS = ParameterTable()

    page = render_nodes([Filter, Plain], level=3)
    assert page.startswith("### filter\n\nEstimates things.\n\n| parameter |")
    assert "### plain\n\nNo parameters of its own.\n" in page
    assert page.count("| `frame_prefix` |") == 1


def test_shared_parameter_is_listed_once_and_conflicting_ones_are_refused():
    shared = Parameter("robot_file", "", "Path")
    assert len(ParameterTable(shared, shared)) == 1
    with pytest.raises(ValueError, match="two different parameters are called robot_file"):
        ParameterTable(shared, Parameter("robot_file", "x", "Path"))


def test_live_name_that_is_no_setting_is_refused():
    with pytest.raises(ValueError, match="live names no setting: gian"):
        ParameterTable.from_settings(FilterSettings, live=("gian",))


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("gain", 9.0, "x", "", 0.0, 5.0), "at most 5"),
        (("mode", "x", "m", "", None, None, ("a",)), "one of a"),
        (("empty", (), "x"), "must have an element"),
        (("thing", {"a": 1}, "x"), "no parameter can be a dict"),
        (("silent", 1.0, ""), "needs a name and a description"),
    ],
)
def test_declaration_that_contradicts_itself_is_refused(arguments, reason):
    with pytest.raises(ValueError, match=reason):
        Parameter(*arguments)
