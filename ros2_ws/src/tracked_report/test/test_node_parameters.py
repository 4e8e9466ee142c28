import pytest

from tracked_report.node_parameters import node_parameters
from tracked_report.scenario import Scenario
from tracked_types import PIPELINE_LATENCY_S, PLAN_RATE_HZ

SCENARIO = Scenario.model_validate(
    {
        "name": "example",
        "world": "step",
        "seed": 7,
        "duration_s": 20.0,
        "pipeline_latency_s": 0.1,
        "reference": {"shape": "s_curve", "parameters": {"length_m": 4.0, "swings": 2}},
        "parameters": {"ekf": {"patience_s": 0.02}, "upper_nmpc": {"horizon": 12}},
        "variants": {
            "single": {"layers": "single", "suspension": "locked"},
            "double": {"parameters": {"upper_nmpc": {"pipeline_latency_s": 0.2}}},
        },
    }
)


def test_words_of_the_scenario_become_parameters_of_the_nodes_they_concern() -> None:
    parameters = node_parameters(SCENARIO, "single")
    assert parameters["sim_bridge"] == {
        "world": "step",
        "seed": 7,
        "time_mode": "lock_step",
        "start": "default",
        "suspension": "locked",
    }
    assert parameters["upper_nmpc"]["layers"] == "single"
    assert parameters["trajectory_player"] == {"rate_hz": 5, "length_m": 4.0, "swings": 2, "shape": "s_curve"}
    assert isinstance(parameters["trajectory_player"]["swings"], int)
    assert parameters["ekf"] == {"patience_s": 0.02}


def test_parameters_spelled_out_for_a_node_override_the_words_of_the_scenario() -> None:
    upper = node_parameters(SCENARIO, "double")["upper_nmpc"]
    assert upper == {"layers": "double", "method": "improved", "rate_hz": 5, "pipeline_latency_s": 0.2, "horizon": 12}


def test_everyone_counts_with_the_rate_and_the_latency_of_the_plans() -> None:
    of_planner = SCENARIO.model_copy(update={"parameters": {"upper_nmpc": {"rate_hz": 10, "pipeline_latency_s": 0.2}}})
    of_scenario = SCENARIO.model_copy(update={"plan_rate_hz": 10, "pipeline_latency_s": 0.2})
    for scenario in (of_planner, of_scenario):
        parameters = node_parameters(scenario, "double")
        assert parameters["upper_nmpc"]["rate_hz"] == parameters["lower_nmpc"]["plan_rate_hz"] == 10
        assert parameters["trajectory_player"]["rate_hz"] == 10
        assert parameters["upper_nmpc"]["pipeline_latency_s"] == parameters["lower_nmpc"]["pipeline_latency_s"] == 0.2


def test_a_scenario_that_says_nothing_means_what_the_nodes_do_by_themselves() -> None:
    silent = Scenario.model_validate({"name": "silent", "world": "flat", "duration_s": 1.0})
    parameters = node_parameters(silent, "double")
    assert parameters["lower_nmpc"]["pipeline_latency_s"] == PIPELINE_LATENCY_S
    assert parameters["lower_nmpc"]["plan_rate_hz"] == PLAN_RATE_HZ


def test_an_unknown_variant_is_refused() -> None:
    with pytest.raises(KeyError):
        node_parameters(SCENARIO, "triple")
