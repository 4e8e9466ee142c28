import pytest

from tracked_lab.campaign.run_inputs import RunInputs, UnknownWayError
from tracked_lab.campaign.spec import CampaignSpec, load_spec
from tracked_lab.conditions import Conditions
from tracked_report.scenario import Scenario
from tracked_types.checked_yaml import CheckedFileError

SCENARIO = {"name": "s", "world": "flat", "duration_s": 1.0, "reference": {"shape": "line"}}


def spec(**changes):
    content = {
        "name": "c",
        "scenario": SCENARIO,
        "ways": ["single", "mppi", "double"],
        "seeds": {"first": 5, "count": 3},
    }
    return CampaignSpec.model_validate(content | changes)


AXES = {
    "latency": {"none": {"scenario.pipeline_latency_s": 0.0}, "some": {"scenario.pipeline_latency_s": 0.2}},
    "pose": {"odometry": {}, "lidar": {"conditions.pose": "lidar"}},
}


def test_a_grid_has_every_combination_once():
    runs = spec(axes=AXES).runs()
    assert len(runs) == 3 * 3 * 4 == len({run.key for run in runs})
    some = [run for run in runs if run.cell == {"latency": "some", "pose": "lidar"} and run.way == "mppi"]
    assert [run.scenario.seed for run in some] == [5, 6, 7]
    assert {run.scenario.pipeline_latency_s for run in some} == {0.2} and {run.conditions.pose for run in some} == {
        "lidar"
    }


def test_a_random_design_draws_cells_and_draws_them_alike():
    drawn = spec(axes=AXES, design="random", samples=2, draw_seed=4)
    assert len(drawn.cells()) == 2 and drawn.cells() == spec(axes=AXES, design="random", samples=2, draw_seed=4).cells()


def test_labels_do_not_change_a_run_but_seeds_weights_and_conditions_do():
    scenario = Scenario.model_validate(SCENARIO)
    run = RunInputs(scenario=scenario, way="double")
    assert run.key == run.model_copy(update={"cell": {"a": "b"}}).key
    others = [
        run.model_copy(update={"scenario": scenario.model_copy(update={"seed": 9})}),
        run.model_copy(update={"weights": "0123"}),
        run.model_copy(update={"conditions": Conditions(pose="lidar")}),
        run.model_copy(update={"way": "single"}),
    ]
    assert len({run.key, *[other.key for other in others]}) == 5


def test_inputs_survive_json_with_their_key():
    for run in spec(axes=AXES).runs()[:7]:
        assert RunInputs.model_validate_json(run.model_dump_json()).key == run.key


def test_weights_that_have_changed_since_are_not_used():
    with pytest.raises(ValueError, match=r"single\.yaml have changed"):
        RunInputs(scenario=Scenario.model_validate(SCENARIO), way="single", weights="000").record()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"ways": ["hover"]}, "unknown way to drive 'hover'"),
        ({"ways": []}, "ways"),
        ({"seeds": {"first": -1}}, "seeds.first"),
        ({"seeds": {"count": 0}}, "seeds.count"),
        ({"axes": {"pose": {}}}, "the grid would be empty"),
        ({"baseline": "opti"}, "baseline must be one of"),
        ({"main": {"pose": "lidar"}}, "main.pose"),
        ({"time_limit_s": 0.0}, "time_limit_s"),
    ],
)
def test_a_campaign_that_means_nothing_is_refused_by_the_key(changes, words):
    with pytest.raises((ValueError, UnknownWayError)) as refused:
        spec(**changes)
    assert words in str(refused.value) or words.split(".")[-1] in str(refused.value)


@pytest.mark.parametrize(
    "change",
    [{"scenario.wheels": 4}, {"conditions.pose": "gps"}, {"weather.rain": 1}, {"seed": 4}, {"scenario.seed.x": 1}],
)
def test_an_axis_that_changes_what_does_not_exist_is_refused(change):
    with pytest.raises(CheckedFileError):
        spec(axes={"odd": {"one": change}}).runs()


def test_packaged_campaigns_load_and_an_unknown_one_lists_them():
    for name in ("table_5_1", "table_5_1_belts", "peers"):
        assert load_spec(name).runs()
    with pytest.raises(CheckedFileError, match="table_5_1"):
        load_spec("table_6_1")
