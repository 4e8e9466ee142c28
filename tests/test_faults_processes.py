"""Processes of a driving robot that hang or die: it stops within its limits, and drives on as soon as it can.

The tests share one graph, in the order of this file; each begins with a robot that drives.
"""

import itertools
import signal

import pytest
from tracked_interfaces.msg import SafetyState

from tests.support.domains import own_domain
from tests.support.driving import driving_graph, stamp_ns
from tracked_description import load_robot

ROBOT = load_robot()
# Watchdog, transport delay, braking from 0.35 m/s, belts behind their set-points, two control periods to notice.
STOP_LIMIT_S = 0.2 + 0.04 + 0.35 / ROBOT.limits.braking_mps2 + 4 * 0.06 + 2 / 30
# The lower layer follows a plan, and the upper layer a reference, until it is too old.
PLAN_LIMIT_S, REFERENCE_LIMIT_S = 0.6 + 0.2, 1.0 + 0.8


@pytest.fixture(scope="module")
def graph(tmp_path_factory):
    with own_domain() as domain, driving_graph(domain, tmp_path_factory.mktemp("faults")) as driving:
        yield driving


@pytest.fixture
def driving(graph):
    graph.until_it_drives()
    return graph


def assert_gentle(commands):
    """No command of a stop brakes harder than the robot may."""
    for before, after in itertools.pairwise(commands):
        period_s = max((stamp_ns(after) - stamp_ns(before)) * 1e-9, 1 / 30)
        slower_mps = before.twist.linear.x - after.twist.linear.x
        assert slower_mps <= ROBOT.limits.braking_mps2 * period_s + 1e-6


@pytest.mark.parametrize(
    ("node", "limit_s", "reason"),
    [
        ("lower_nmpc", STOP_LIMIT_S, "nav silent"),
        ("trajectory_player", STOP_LIMIT_S + PLAN_LIMIT_S + REFERENCE_LIMIT_S, ""),
        ("ekf", STOP_LIMIT_S, "silent"),
        ("command_arbiter", STOP_LIMIT_S, ""),
    ],
)
def test_a_node_that_hangs_is_a_stop_until_it_goes_on(driving, node, limit_s, reason):
    first, since_ns = len(driving.commands), driving.now_ns
    driving.graph.signal_child(node, signal.SIGSTOP)
    try:
        assert driving.time_to_rest_s(since_ns) < limit_s
        if reason:
            driving.wait_until(lambda: driving.states[-1].state == SafetyState.STOPPED, "the stop to be told")
            assert reason in driving.states[-1].reason
            assert driving.commands[-1].twist.linear.x == 0.0
    finally:
        driving.graph.signal_child(node, signal.SIGCONT)
    assert_gentle(driving.commands[first:])
    driving.until_it_drives()
    driving.wait_until(lambda: driving.states[-1].state == SafetyState.FORWARDING, "the drive to be told")


@pytest.mark.parametrize(
    ("node", "limit_s"), [("lower_nmpc", STOP_LIMIT_S), ("upper_nmpc", STOP_LIMIT_S + PLAN_LIMIT_S)]
)
def test_a_killed_layer_is_a_stop_until_the_bringup_has_started_it_again(driving, node, limit_s):
    first, since_ns = len(driving.commands), driving.now_ns
    killed = driving.graph.signal_child(node, signal.SIGKILL)
    assert driving.time_to_rest_s(since_ns) < limit_s
    assert_gentle(driving.commands[first:])
    driving.until_it_drives()
    assert driving.graph.children[node] != killed
    assert f"[{node}] ended (signal 9): started again, 1 of 3" in driving.graph.output


def test_without_odometry_the_run_ends_and_the_robot_is_left_at_rest(driving):
    first = len(driving.commands)
    driving.graph.signal_child("ekf", signal.SIGKILL)
    assert driving.graph.wait() == 1
    assert "ekf ended (signal 9)" in driving.graph.output
    assert "logs: " in driving.graph.output
    assert driving.graph.left_behind() == []
    driving.listener.refresh()
    assert driving.commands[-1].twist.linear.x == 0.0
    assert driving.commands[-1].twist.angular.z == 0.0
    assert_gentle(driving.commands[first:])
