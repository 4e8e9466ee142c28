import numpy as np
import pytest
import yaml

from nmpc_layers import load_weights
from tracked_lab.conditions import Conditions
from tracked_lab.table_variants import BASELINE, TABLE_VARIANTS
from tracked_lab.weight_search import proposals, write_weights


def found(name, budget, seed=0):
    """Best of a search for a heading weight near 3 and a speed weight near 1."""
    tried = []
    for proposal in proposals(TABLE_VARIANTS[name], budget, np.random.default_rng(seed)):
        weights = list(proposal.roles.values())
        proposal.score = sum(np.log(each.heading / 3.0) ** 2 + np.log(each.speed) ** 2 for each in weights)
        tried.append(proposal)
    return tried


@pytest.mark.parametrize("name", TABLE_VARIANTS)
def test_every_way_to_drive_gets_the_same_number_of_trials_and_begins_with_the_packaged_weights(name):
    way, tried = TABLE_VARIANTS[name], found(name, 20)
    packaged = load_weights().of(way.method)
    assert len(tried) == 20
    assert tried[0].roles == {role: getattr(packaged, role) for role in way.roles}


def test_the_search_closes_in_on_the_best():
    tried = found("double_improved", 200)
    assert min(proposal.score for proposal in tried) < 0.1 * np.median([proposal.score for proposal in tried[:60]])


def test_equal_seeds_search_alike():
    assert [one.roles for one in found("single", 30)] == [other.roles for other in found("single", 30)]


def test_weights_that_are_written_are_those_that_are_read(tmp_path):
    proposal = found("double_improved", 5)[-1]
    file = tmp_path / "weights" / "found.yaml"
    write_weights(proposal.roles, file, "# found\n")
    for method in ("improved", "thesis"):
        weights = load_weights(file).of(method)
        assert {"upper": weights.upper, "lower": weights.lower} == dict(proposal.roles)
    assert yaml.safe_load(file.read_text())["improved"]["single"]["position"] == 20.0


@pytest.mark.parametrize("name", TABLE_VARIANTS)
def test_weights_reach_whoever_drives(name):
    way = TABLE_VARIANTS[name]
    nodes = way.with_weights("w.yaml").parameters
    conditions = way.with_weights_in(Conditions(), "w.yaml")
    assert nodes["upper_nmpc"]["weights_file"] == nodes["lower_nmpc"]["weights_file"] == "w.yaml"
    assert (conditions.steering_parameters == {}) == (conditions.steering == "nmpc")


def test_the_baseline_is_one_of_them():
    assert BASELINE in TABLE_VARIANTS
