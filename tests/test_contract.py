"""The contract of docs/topics.md against a running graph: names, types, ends, QoS, rates, frames, TF."""

import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.qos import DurabilityPolicy, ReliabilityPolicy

from node_kit.rotations import yaw_from_quaternion
from tests.support.contract import CONTRACT
from tracked_bringup.node_table import load_node_table
from tracked_description import load_robot
from tracked_types import PeriodGrid

ROBOT = load_robot()
OF_EVERY_NODE = {"clock", "diagnostics"}
"""What every node has by itself: no row of the node table."""
ONLOOKERS = {"recorder", "bringup", "test_listener"}
TOPICS = pytest.mark.parametrize("row", CONTRACT, ids=[row.topic for row in CONTRACT])
PERIODIC = pytest.mark.parametrize(
    "row", [row for row in CONTRACT if row.rate_hz], ids=[row.topic for row in CONTRACT if row.rate_hz]
)
TAKING_PART = frozenset(name for name, entry in load_node_table().nodes.items() if not entry.optional)
"""Of the nodes, those in the run that is looked at; optional ones have tests of their own."""
ALL_NODES = frozenset().union(*(row.publishers | row.subscribers for row in CONTRACT)) & TAKING_PART


def names(endpoints):
    return {endpoint.node_name for endpoint in endpoints} - ONLOOKERS


def stamps(messages):
    return [
        stamp.sec * 10**9 + stamp.nanosec
        for stamp in (message.clock if hasattr(message, "clock") else message.header.stamp for message in messages)
    ]


@TOPICS
def test_the_right_nodes_publish_and_subscribe_it_with_the_right_type(step_run, row):
    publishers, subscribers = step_run.endpoints.publishers[row.topic], step_run.endpoints.subscribers[row.topic]
    assert names(publishers) == row.publishers & TAKING_PART
    assert names(subscribers) >= row.subscribers & TAKING_PART
    package, kind = row.type.__module__.split(".")[0], row.type.__name__
    assert {endpoint.topic_type for endpoint in [*publishers, *subscribers]} <= {f"{package}/msg/{kind}"}


@TOPICS
def test_nothing_of_it_can_be_lost_and_late_comers_get_what_is_latched(step_run, row):
    durability = DurabilityPolicy.TRANSIENT_LOCAL if row.latched else DurabilityPolicy.VOLATILE
    for endpoint in step_run.endpoints.publishers[row.topic]:
        assert endpoint.qos_profile.reliability is ReliabilityPolicy.RELIABLE
        assert endpoint.qos_profile.durability is durability


@TOPICS
def test_nobody_in_it_listens_to_lossy_streams(step_run, row):
    for endpoint in step_run.endpoints.subscribers[row.topic]:
        # Of the clock, which rclpy subscribes, only the newest matters.
        if row.topic != "clock" and endpoint.node_name in row.subscribers | {"recorder"}:
            assert endpoint.qos_profile.reliability is ReliabilityPolicy.RELIABLE, endpoint.node_name


def test_the_node_table_says_who_publishes_and_who_listens():
    entries = load_node_table().nodes
    for row in CONTRACT:
        publishers = {name for name, entry in entries.items() if row.topic in entry.publishes}
        listeners = {name for name, entry in entries.items() if row.topic in entry.subscribes} - ONLOOKERS
        if row.topic in OF_EVERY_NODE:
            continue
        assert publishers == row.publishers, row.topic
        assert listeners == (row.subscribers if row.publishers else set()), row.topic


@PERIODIC
def test_its_stamps_are_the_instants_of_its_grid_without_a_gap(step_run, row):
    # Some time after the goal the nodes are told to end, and the arbiter's last ramp has stamps of its own.
    end = stamps(step_run.messages["goal_reached"])[0]
    found = [stamp for stamp in stamps(step_run.messages[row.topic]) if stamp <= end]
    grid = PeriodGrid(row.rate_hz)
    first = grid.index_at(found[0])
    assert found == [grid.stamp_ns(first + index) for index in range(len(found))]
    assert end - found[-1] < 0.5e9, "it went on to the end"


@PERIODIC
def test_its_frame_is_the_one_agreed_on(step_run, row):
    if row.topic != "clock":
        assert {message.header.frame_id for message in step_run.messages[row.topic]} == {row.frame}


@pytest.mark.parametrize("topic", ["odom", "ground_truth/odom"])
def test_odometry_is_of_the_base(step_run, topic):
    assert {message.child_frame_id for message in step_run.messages[topic]} == {ROBOT.frames.base_footprint}


def test_the_stack_never_sees_the_truth(step_run):
    for topic, endpoints in step_run.endpoints.subscribers.items():
        if topic.startswith("ground_truth/"):
            assert not names(endpoints)


def test_every_odometry_has_its_transform(step_run):
    moving = [transform for message in step_run.messages["tf"] for transform in message.transforms]
    frames = {(transform.header.frame_id, transform.child_frame_id) for transform in moving}
    assert frames == {(ROBOT.frames.odom, ROBOT.frames.base_footprint)}
    assert stamps(moving) == stamps(step_run.messages["odom"])
    for transform, odometry in zip(moving, step_run.messages["odom"], strict=True):
        assert transform.transform.translation.x == odometry.pose.pose.position.x
        turned, tilted = transform.transform.rotation, odometry.pose.pose.orientation
        heading = yaw_from_quaternion(tilted.x, tilted.y, tilted.z, tilted.w)
        assert (turned.x, turned.y) == (0.0, 0.0), "base_footprint stays level; the odometry says how the base tilts"
        assert yaw_from_quaternion(0.0, 0.0, turned.z, turned.w) == pytest.approx(heading, abs=1e-9)


def test_the_frames_form_one_tree_below_odom(step_run):
    messages = [*step_run.messages["tf"][:1], *step_run.messages["tf_static"]]
    parents = {
        transform.child_frame_id: transform.header.frame_id for message in messages for transform in message.transforms
    }
    frames = dict(ROBOT.frames)
    assert set(parents) | {frames["odom"]} >= set(frames.values())
    for frame in parents:
        for _ in parents:
            frame = parents.get(frame, frame)
        assert frame == frames["odom"]


def test_every_node_tells_how_it_is_and_has_no_complaint_about_its_inputs(step_run):
    statuses = [status for message in step_run.messages["diagnostics"] for status in message.status]
    told = {}
    for status in statuses:
        node, _, task = status.name.partition(": ")
        told.setdefault(node, set()).add(task)
        if task in ("inputs", "callbacks", "parameters"):
            assert status.level == DiagnosticStatus.OK, f"{status.name}: {status.message}"
    assert set(told) >= ALL_NODES
    assert all("inputs" in tasks for tasks in told.values())
