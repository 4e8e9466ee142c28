import pytest

from tracked_report.describe_run import describe_run
from tracked_report.run_record import CommandLimits
from tracked_report.scenario import Scenario
from tracked_types import Outline

LIMITS = CommandLimits(speed_min_mps=-0.4, speed_max_mps=0.5, yaw_rate_max_radps=1.3)
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
    meta = describe_run(SCENARIO, "double", limits=LIMITS, suspension="qzs", scene=[Outline.circle(0.0, 0.0, 1.0)])
    assert (meta.description, meta.variant_description) == ("all of it", "two layers")
    assert meta.versions["numpy"]
    assert meta.machine["python"]
    assert len(meta.scene) == 1


def test_the_suspension_of_the_variant_comes_before_that_of_the_robot():
    assert describe_run(SCENARIO, "double", limits=LIMITS, suspension="qzs").suspension == "qzs"
    assert describe_run(SCENARIO, "stiff", limits=LIMITS, suspension="qzs").suspension == "locked"


def test_an_unknown_variant_is_an_error():
    with pytest.raises(KeyError):
        describe_run(SCENARIO, "triple", limits=LIMITS, suspension="qzs")
