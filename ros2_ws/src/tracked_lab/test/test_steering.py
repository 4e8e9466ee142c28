"""Ways to steer by name, one fast layer, oracle slip."""

from typing import Any

import numpy as np
import pytest

from tracked_description import load_robot
from tracked_lab import drive
from tracked_lab.conditions import Conditions
from tracked_lab.fast_layer import FastLayer
from tracked_lab.steering_registry import UnknownSteeringError, make_steering
from tracked_lab.tuning import UnknownParameterError
from tracked_report.metrics import run_metrics
from tracked_report.scenario import Scenario

ROBOT = load_robot()


def scenario(**changes: Any) -> Scenario:
    content: dict[str, Any] = {
        "name": "trial",
        "world": "flat",
        "seed": 1200,
        "duration_s": 9.0,
        "reference": {"shape": "s_curve", "parameters": {"swings": 1}},
        "variants": {"double": {}, "thesis": {"method": "thesis"}},
    }
    return Scenario.model_validate(content | changes)


def figures(variant="double", seed=1200, **conditions: Any) -> dict[str, float]:
    record = drive(scenario(seed=seed), variant, conditions=Conditions(plant="kinematic", **conditions))
    return run_metrics(record).values


def test_an_unknown_steering_is_refused_with_the_names_there_are():
    with pytest.raises(UnknownSteeringError, match=r"steering must be one of nmpc, fast_layer.*'wishful'"):
        drive(scenario(), "double", conditions=Conditions(steering="wishful"))


def test_parameters_that_nobody_reads_are_refused():
    with pytest.raises(UnknownParameterError, match="lower_nmpc has no parameter 'haste'"):
        make_steering("fast_layer", ROBOT, {"haste": 1.0})
    with pytest.raises(ValueError, match="steering_parameters"):
        drive(scenario(), "double", conditions=Conditions(steering_parameters={"horizon": 3}))


def test_the_fast_layer_follows_the_reference_alone():
    values = figures(steering="fast_layer")
    assert values["estimated.rms_distance_m"] < 0.03
    assert values["estimated.rms_theta_rad"] < 0.1
    assert "solver.upper_median_ms" not in values and values["solver.lower_not_converged"] < 20


def test_the_fast_layer_gets_its_reference_as_late_as_others_get_plans():
    layer = make_steering("fast_layer", ROBOT, {"pipeline_latency_s": 0.2, "plan_rate_hz": 5, "seed": 1})
    assert isinstance(layer, FastLayer)
    record = drive(scenario(pipeline_latency_s=0.2), "double", conditions=Conditions(steering="fast_layer"))
    reference, commands = record.channel("reference"), record.channel("cmd_vel_nav")
    waited_s = (commands.stamps_ns[0] - reference.stamps_ns[0]) / 1e9
    assert waited_s == pytest.approx(0.2, abs=2 / 30)


def test_oracle_slip_reaches_the_steering_and_the_record_keeps_the_estimate():
    estimated, oracle = (
        drive(scenario(), "double", conditions=Conditions(plant="kinematic", slip_source=source))
        for source in ("estimated", "oracle")
    )
    assert not np.array_equal(estimated.channel("cmd_vel").values, oracle.channel("cmd_vel").values)
    at_rest = estimated.channel("slip").stamps_ns < 1_500_000_000
    np.testing.assert_array_equal(
        estimated.channel("slip").values[at_rest], oracle.channel("slip").values[: int(at_rest.sum())]
    )
    assert run_metrics(oracle).values["slip.yaw_rate_rms_radps"] > 0.001
