"""What conditions mean for a drive, and what is refused."""

import json
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from tracked_lab import drive
from tracked_lab.conditions import Conditions, Link, Links
from tracked_report.metrics import run_metrics
from tracked_report.run_record import RunRecord
from tracked_report.scenario import Scenario

CHANNELS = ("truth", "truth_slip", "tracks", "odometry", "slip", "reference", "cmd_vel")


def scenario(**changes: Any) -> Scenario:
    content: dict[str, Any] = {
        "name": "trial",
        "world": "flat",
        "seed": 1400,
        "duration_s": 5.0,
        "reference": {"shape": "s_curve", "parameters": {"swings": 1}},
        "variants": {"double": {}, "single": {"layers": "single"}},
    }
    return Scenario.model_validate(content | changes)


def same(one: RunRecord, other: RunRecord) -> bool:
    return all(np.array_equal(one.channel(name).values, other.channel(name).values) for name in CHANNELS)


def test_conditions_survive_being_written_down():
    conditions = Conditions(
        plant="kinematic",
        pose="lidar",
        slip_severity=2.0,
        links=Links(plan=Link(latency_s=0.1, loss=0.1)),
        steering="mppi",
        steering_parameters={"samples": 1000, "gamma": 0.015},
    )
    assert Conditions.model_validate_json(conditions.model_dump_json()) == conditions
    assert Conditions.model_validate({}) == Conditions()


@pytest.mark.parametrize(
    "wrong", [{"plant": "rubber"}, {"slip_severity": -1.0}, {"pose": "gps"}, {"obstacles": True}, {"steering": ""}]
)
def test_conditions_that_cannot_be_are_refused_by_the_name_of_their_key(wrong):
    with pytest.raises(ValidationError, match=next(iter(wrong))):
        Conditions.model_validate(wrong)


@pytest.mark.parametrize("plant", ["belts", "kinematic"])
def test_the_same_inputs_give_the_same_record_bit_for_bit(plant):
    conditions = Conditions(plant=plant, obstacle=True, varied_ground=True)
    first, again = (drive(scenario(), "double", conditions=conditions) for _ in range(2))
    assert same(first, again)
    assert not same(first, drive(scenario(seed=1401), "double", conditions=conditions))


def test_both_plants_give_records_of_the_same_kind():
    records = [drive(scenario(), "double", conditions=Conditions(plant=plant)) for plant in ("belts", "kinematic")]
    for name in CHANNELS:
        belts, kinematic = (record.channel(name) for record in records)
        assert belts.columns == kinematic.columns
        np.testing.assert_array_equal(belts.stamps_ns[:100], kinematic.stamps_ns[:100])
    for record in records:
        assert run_metrics(record).values["estimated.rms_distance_m"] < 0.05


def test_one_plants_ground_does_not_depend_on_who_drives_on_it():
    variants = [
        drive(scenario(duration_s=1.5), name, conditions=Conditions(plant="kinematic")) for name in ("double", "single")
    ]
    np.testing.assert_array_equal(*(record.channel("odometry").values for record in variants))


def test_the_record_says_its_conditions_and_when_the_obstacle_acted_on_the_moving_robot():
    conditions = Conditions(plant="kinematic", obstacle=True)
    record = drive(scenario(duration_s=8.0), "double", conditions=conditions)
    assert json.loads(str(record.meta.notes["conditions"])) == {"plant": "kinematic", "obstacle": True}
    reference = record.channel("reference")
    moves = np.flatnonzero(np.abs(reference.column("speed_mps")) > 0.0)
    begins_s = reference.stamps_ns[moves[0] - 1] / 1e9
    assert record.meta.disturbed_s == pytest.approx((begins_s + 1.6, begins_s + 2.2), abs=0.06)
    calm = drive(scenario(duration_s=8.0), "double", conditions=conditions.model_copy(update={"obstacle": False}))
    assert calm.meta.disturbed_s is None
    apart = np.abs(record.channel("truth").column("yaw_rad") - calm.channel("truth").column("yaw_rad"))
    times = record.channel("truth").seconds()
    begin_s, end_s = record.meta.disturbed_s
    assert apart[times < begin_s].max() == 0.0
    assert apart[(times > begin_s) & (times < end_s)].max() > 0.1


def test_the_robot_comes_back_after_the_obstacle_and_the_metrics_say_when():
    record = drive(scenario(duration_s=10.0), "double", conditions=Conditions(plant="kinematic", obstacle=True))
    assert 0.0 < run_metrics(record).values["estimated.recovery_s"] < 3.0


def test_faults_belong_to_the_simulator():
    faults = ({"at_s": 1.5, "kind": "blackout", "target": "tracks"},)
    with pytest.raises(ValueError, match="faults: the kinematic plant knows none"):
        drive(scenario(faults=faults), "double", conditions=Conditions(plant="kinematic"))


def test_a_start_that_the_world_does_not_have_is_refused_on_either_plant():
    for plant in ("belts", "kinematic"):
        with pytest.raises(ValueError, match="no start 'moon'"):
            drive(scenario(start="moon"), "double", conditions=Conditions(plant=plant))


def test_the_kinematic_plant_starts_where_the_scenario_says():
    start = {"x_m": 1.0, "y_m": -2.0, "yaw_rad": 0.5}
    record = drive(scenario(start=start, duration_s=0.5), "double", conditions=Conditions(plant="kinematic"))
    assert record.channel("truth").values[0, [0, 1, 5]] == pytest.approx([1.0, -2.0, 0.5])
    assert record.meta.odom_in_world == (1.0, -2.0, 0.5)
