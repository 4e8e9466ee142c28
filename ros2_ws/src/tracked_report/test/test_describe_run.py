import pytest

from tracked_description import load_robot
from tracked_report.describe_run import describe_run
from tracked_report.scenario import Scenario
from tracked_types import Outline

ROBOT = load_robot()
SCENARIO = Scenario.model_validate(
    {
        "name": "trial",
        "description": "all of it",
        "world": "flat",
        "duration_s": 5.0,
        "variants": {"double": {"description": "two layers"}, "stiff": {"suspension": "locked"}},
    }
)


def test_a_run_is_described_by_its_scenario_its_variant_and_where_it_runs():
    meta = describe_run(SCENARIO, "double", ROBOT, [Outline.circle(0.0, 0.0, 1.0)])
    assert (meta.description, meta.variant_description) == ("all of it", "two layers")
    assert meta.versions["numpy"]
    assert meta.machine["python"]
    assert len(meta.scene) == 1
    assert meta.limits is not None and meta.limits.speed_max_mps == ROBOT.limits.speed_max_mps


def test_the_suspension_of_the_variant_comes_before_that_of_the_robot():
    assert describe_run(SCENARIO, "double", ROBOT).suspension == ROBOT.suspension.kind
    assert describe_run(SCENARIO, "stiff", ROBOT).suspension == "locked"


def test_an_unknown_variant_is_an_error():
    with pytest.raises(KeyError):
        describe_run(SCENARIO, "triple", ROBOT)
