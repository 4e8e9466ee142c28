import numpy as np
import pytest
import yaml

from nmpc_layers import load_weights
from tracked_lab.conditions import Conditions
from tracked_lab.parameter_search import proposals
from tracked_lab.peers import PEERS
from tracked_lab.peers.ranges import PEER_RANGES, start_of
from tracked_lab.table_variants import BASELINE, TABLE_VARIANTS
from tracked_lab.weight_search import packaged_point, roles_of, weight_ranges, write_weights

RANGES = {"a": (0.1, 10.0), "b": (0.01, 1.0)}


def tried(budget, seed=0):
    """A search for a = 3, b = 0.1."""
    found = []
    for proposal in proposals({"a": 1.0, "b": 1.0}, RANGES, budget, np.random.default_rng(seed)):
        proposal.score = np.log(proposal.point["a"] / 3.0) ** 2 + np.log(proposal.point["b"] / 0.1) ** 2
        found.append(proposal)
    return found


def test_a_search_begins_where_it_is_told_keeps_its_budget_and_its_ranges():
    found = tried(40)
    assert len(found) == 40 and found[0].point == {"a": 1.0, "b": 1.0}
    assert all(RANGES[name][0] <= value <= RANGES[name][1] for one in found for name, value in one.point.items())


def test_a_search_closes_in_on_the_best():
    found = tried(150)
    assert min(one.score for one in found) < 0.05 < np.median([one.score for one in found[:50]])


def test_equal_seeds_search_alike():
    assert [one.point for one in tried(30)] == [one.point for one in tried(30)]


@pytest.mark.parametrize("name", TABLE_VARIANTS)
def test_the_search_of_a_way_to_drive_starts_from_the_packaged_weights(name):
    way = TABLE_VARIANTS[name]
    packaged, start = load_weights().of(way.method), packaged_point(way)
    assert start.keys() == weight_ranges(way).keys()
    assert roles_of(start) == {role: getattr(packaged, role) for role in way.roles}


def test_weights_that_are_written_are_those_that_are_read(tmp_path):
    roles = roles_of(packaged_point(TABLE_VARIANTS["double_as_printed"]))
    file = tmp_path / "weights" / "found.yaml"
    write_weights(roles, file, "# found\n")
    for method in ("improved", "thesis"):
        weights = load_weights(file).of(method)
        assert {"upper": weights.upper, "lower": weights.lower} == roles
    assert yaml.safe_load(file.read_text())["improved"]["single"]["position"] == 20.0


@pytest.mark.parametrize("name", TABLE_VARIANTS)
def test_weights_reach_whoever_drives(name):
    way = TABLE_VARIANTS[name]
    nodes = way.with_weights("w.yaml").parameters
    conditions = way.with_weights_in(Conditions(), "w.yaml")
    assert nodes["upper_nmpc"]["weights_file"] == nodes["lower_nmpc"]["weights_file"] == "w.yaml"
    assert (conditions.steering_parameters == {}) == (conditions.steering == "nmpc")


@pytest.mark.parametrize("name", PEER_RANGES)
def test_what_is_searched_of_a_peer_are_its_parameters_and_its_defaults_are_in_range(name):
    assert name in PEERS
    for parameter, value in start_of(name).items():
        low, high = PEER_RANGES[name][parameter]
        assert low <= value <= high


def test_the_baseline_is_one_of_the_ways_to_drive():
    assert BASELINE in TABLE_VARIANTS
