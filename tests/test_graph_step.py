"""The step scenario end to end: the graph arrives, and it drives as the same algorithms do without ROS."""

import numpy as np
import pytest

from tests.support.step_run import SCENARIO, VARIANT
from tracked_bringup.node_table import load_node_table
from tracked_bringup.scenarios import load_scenario
from tracked_lab import drive
from tracked_types import wrap_angle

# In lock-step every node does the same work on the same inputs as in the lab, whoever is faster. What remains is the
# rounding of conversions (angles to quaternions, travel to joint angles), which slipping tracks amplify to some 1e-9.
TOLERANCE = 1e-6
"""In metres, radians, metres and radians per second."""
STEP_HEIGHT_M = 0.04


@pytest.fixture(scope="module")
def lab_record():
    return drive(load_scenario(SCENARIO, [], load_node_table()), VARIANT)


def column(channel, name):
    return channel.values[:, channel.columns.index(name)]


def test_it_reaches_the_goal_and_everybody_ends_well(step_run):
    assert step_run.exit_code == 0
    assert "goal reached" in step_run.output
    assert "ended with an error" not in step_run.output
    assert "forced" not in step_run.output
    assert len(step_run.messages["goal_reached"]) == 1


def test_it_climbs_the_step(step_run):
    height = column(step_run.record.channel("truth"), "z_m")
    assert height.max() == pytest.approx(height[0] + STEP_HEIGHT_M, abs=0.02)
    assert abs(height[-1] - height[0]) < 0.01


@pytest.mark.parametrize("channel", ["truth", "odometry", "slip", "tracks", "reference", "cmd_vel_nav", "cmd_vel"])
def test_its_whole_trajectory_is_that_of_the_lab(step_run, lab_record, channel):
    graph, lab = step_run.record.channel(channel), lab_record.channel(channel)
    _, in_graph, in_lab = np.intersect1d(graph.stamps_ns, lab.stamps_ns, return_indices=True)
    assert len(in_graph) >= 0.98 * len(graph)
    for name in graph.columns:
        if "variance" not in name:
            apart = column(graph, name)[in_graph] - column(lab, name)[in_lab]
            apart = wrap_angle(apart) if name == "yaw_rad" else apart
            assert np.abs(apart).max() < TOLERANCE, name


def test_every_tick_of_both_layers_had_what_it_needed(step_run):
    for layer in ("upper", "lower"):
        status = step_run.messages[f"{layer}_nmpc/status"]
        begun = next(index for index, message in enumerate(status) if message.ok)
        failed = [message.reason for message in status[begun:] if not message.ok]
        assert not failed
