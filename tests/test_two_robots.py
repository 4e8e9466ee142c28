"""Two robots in one domain, each below its own namespace: both drive, and neither hears the other."""

import math
import re

import pytest
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from tf2_msgs.msg import TFMessage

from tests.support.domains import own_domain
from tests.support.graph_process import GraphProcess
from tests.support.listener import own_listener
from tracked_description import load_robot

FRAMES = set(dict(load_robot().frames).values())
ROBOTS = {"r1": "line", "r2": "circle"}
SECONDS = 8  # long enough for an onlooker that is found late
LIMIT_S = 100.0
LOOK_EVERY_S = 0.1
OF_ROS = re.compile(r"/rosout|/parameter_events")


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    """Messages by topic, all topic names there were, and how both runs ended."""
    with own_domain() as domain, own_listener(domain) as listener:
        for robot in ROBOTS:
            for kind, topic in ((Odometry, "odom"), (Odometry, "ground_truth/odom"), (TwistStamped, "cmd_vel")):
                listener.hear(kind, f"{robot}/{topic}")
            listener.hear(TFMessage, f"{robot}/tf")
            listener.hear(TFMessage, f"{robot}/tf_static", latched=True)
        graphs = {
            robot: GraphProcess(
                domain,
                tmp_path_factory.mktemp(robot),
                "track",
                f"namespace:={robot}",
                f"reference.shape:={shape}",
                f"duration_s:={SECONDS}",
                "time:=lock_step",
                "nodes.recorder:=false",
            )
            for robot, shape in ROBOTS.items()
        }
        topics = set()
        try:
            while not all(graph.ends_within(LOOK_EVERY_S) for graph in graphs.values()):
                listener.refresh()
                topics |= {name for name, _ in listener.node.get_topic_names_and_types()}
            listener.refresh()
        finally:
            for graph in graphs.values():
                graph.end()
        yield listener.messages, topics, graphs


def test_both_runs_end_well(both):
    _, _, graphs = both
    for graph in graphs.values():
        assert graph.wait() == 0, graph.output
        assert "ended with an error" not in graph.output


def test_every_topic_lies_below_a_namespace(both):
    _, topics, _ = both
    assert [name for name in topics if not OF_ROS.fullmatch(name) and name.split("/")[1] not in ROBOTS] == []


@pytest.mark.parametrize("robot", ROBOTS)
def test_every_frame_has_the_prefix_of_its_robot(both, robot):
    messages, _, _ = both
    transforms = [
        transform
        for topic in ("tf", "tf_static")
        for message in messages[f"{robot}/{topic}"]
        for transform in message.transforms
    ]
    frames = {name for transform in transforms for name in (transform.header.frame_id, transform.child_frame_id)}
    assert frames >= {f"{robot}/{frame}" for frame in FRAMES}
    assert all(frame.startswith(f"{robot}/") for frame in frames)
    assert messages[f"{robot}/odom"][-1].header.frame_id == f"{robot}/odom"
    assert messages[f"{robot}/cmd_vel"][-1].header.frame_id == f"{robot}/base_footprint"


def test_each_follows_its_own_reference(both):
    messages, _, _ = both
    headings = {}
    for robot in ROBOTS:
        pose = messages[f"{robot}/ground_truth/odom"][-1].pose.pose
        assert pose.position.x > 0.4
        headings[robot] = 2.0 * math.atan2(pose.orientation.z, pose.orientation.w)
    assert abs(headings["r1"]) < 0.1
    assert headings["r2"] > 0.3
