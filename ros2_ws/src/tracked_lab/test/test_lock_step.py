from importlib import resources
from typing import Any

import numpy as np
import pytest

from sim_bridge.faults import FaultRefused
from tracked_lab import drive
from tracked_lab.tuning import UnknownParameterError
from tracked_report.run_record import RunRecord
from tracked_report.scenario import Scenario, load_scenario


def scenario(**changes: Any) -> Scenario:
    content: dict[str, Any] = {
        "name": "trial",
        "world": "flat",
        "seed": 3,
        "duration_s": 4.0,
        "pipeline_latency_s": 0.1,
        "reference": {"shape": "line", "parameters": {"length_m": 0.6, "speed_mps": 0.3}},
        "variants": {"double": {}, "single": {"layers": "single"}},
    }
    return Scenario.model_validate(content | changes)


def test_the_example_of_a_scenario_asks_for_nothing_that_is_not_there() -> None:
    example = load_scenario(resources.files("tracked_report") / "data" / "scenario_example.yaml")
    for variant in example.variants:
        record = drive(example.model_copy(update={"duration_s": 0.1}), variant)
        assert len(record.channel("truth")) == 6


def path(record: RunRecord) -> np.ndarray:
    return record.channel("truth").values[:, :2]


@pytest.mark.parametrize("variant", ["single", "double"])
def test_the_robot_drives_where_the_reference_goes(variant: str) -> None:
    record = drive(scenario(duration_s=6.0), variant)
    assert path(record)[-1] == pytest.approx([0.6, 0.0], abs=0.08)
    assert len(record.channel("odometry")) == pytest.approx(6.0 * 60, abs=2)
    assert len(record.channel("cmd_vel")) > 4.0 * 30


def test_the_same_seed_gives_the_same_drive_bit_for_bit_and_another_seed_does_not() -> None:
    first, second, other = (drive(scenario(duration_s=2.5, seed=seed), "double") for seed in (5, 5, 6))
    for name in ("truth", "odometry", "slip", "cmd_vel"):
        np.testing.assert_array_equal(first.channel(name).values, second.channel(name).values)
    assert not np.array_equal(first.channel("odometry").values, other.channel("odometry").values)


def test_a_sensor_that_falls_silent_stops_the_robot() -> None:
    faults = ({"at_s": 1.5, "kind": "blackout", "target": "tracks"}, {"at_s": 1.5, "kind": "blackout", "target": "imu"})
    record = drive(scenario(faults=faults), "double")
    truth = record.channel("truth")
    assert path(record)[-1, 0] < 0.5
    assert abs(truth.values[-1, truth.columns.index("speed_mps")]) < 0.01


def test_a_parameter_that_no_node_has_is_refused_by_name() -> None:
    with pytest.raises(UnknownParameterError, match="ekf has no parameter 'patience'"):
        drive(scenario(parameters={"ekf": {"patience": 1.0}}), "double")


def test_a_fault_that_does_not_exist_is_refused() -> None:
    with pytest.raises(FaultRefused, match="sensor must be one of"):
        drive(scenario(faults=({"at_s": 1.0, "kind": "blackout", "target": "radar"},)), "double")
