"""What nobody should send, sent to every subscription of every node; and a clock that jumps back.

The nodes stand in two processes: all that belong to a robot in one, with a base on the bench; the simulator in another,
in a namespace of its own. The tests share them, in the order of this file.
"""

from types import SimpleNamespace

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TwistStamped
from rclpy.qos import DurabilityPolicy, QoSProfile

from tests.support.bench_base import BenchBase
from tests.support.contract import CONTRACT
from tests.support.domains import own_domain
from tests.support.driving import START_LIMIT_S, stamp_ns
from tests.support.malformed import malformed
from tests.support.node_process import NodeProcess
from tests.support.probe import own_probe
from tracked_bringup.node_table import load_node_table
from tracked_description import load_robot

ROBOT = load_robot()
TABLE = load_node_table().nodes
ON_THE_BENCH = [name for name, entry in TABLE.items() if name != "sim_bridge" and not entry.optional]
TYPES = {row.topic: row for row in CONTRACT}
NOT_CHECKED = {"parameter_events", "clock"}  # rclpy's own
# A bool cannot be malformed.
HARMLESS = {"e_stop", "lock_teleop", "lock_follow", "lock_nav"}
JUMP_S = 100.0
BURST = 5
ROUNDS = 2
MOST_SECONDS = 8
OFFENDER = "mallory"


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    """Both processes, a base that has driven for a while, and a good message of every topic."""
    folder = tmp_path_factory.mktemp("bench")
    with own_domain() as domain, own_probe(domain) as probe, own_probe(domain, OFFENDER) as offender:
        environment = {"ROS_DOMAIN_ID": str(domain)}
        classes = [TABLE[name].node_class for name in ON_THE_BENCH]
        parameters = ("-p", "use_sim_time:=true", "-p", f"recorder:record_file:={folder / 'record.npz'}")
        robot = NodeProcess(
            ("tracked_bringup", "node_group", *classes, "--ros-args", *parameters), folder / "robot.log", environment
        )
        simulator = NodeProcess(
            ("sim_bridge", "sim_bridge", "--ros-args", "-r", "__ns:=/simulated"), folder / "sim.log", environment
        )
        try:
            base = BenchBase(probe, ROBOT)
            good = {row.topic: probe.collect(row.type, row.topic, _latched(row)) for row in CONTRACT}
            diagnostics = [
                probe.collect(DiagnosticArray, name, 100) for name in ("diagnostics", "simulated/diagnostics")
            ]
            expected = {*ON_THE_BENCH, "sim_bridge"}
            probe.wait_until(
                lambda: expected <= set(probe.node.get_node_names()), timeout_s=START_LIMIT_S, what="all nodes"
            )
            probe.wait_until(lambda: len(probe.node.get_subscriptions_info_by_topic("/odom")) > 4, what="their ears")
            base.jump(JUMP_S + 10.0)
            base.run(1.0)
            yield SimpleNamespace(
                probe=probe,
                offender=offender,
                base=base,
                good=good,
                diagnostics=diagnostics,
                processes=(robot, simulator),
            )
        finally:
            for process in (robot, simulator):
                process.end()


def _latched(row):
    durability = DurabilityPolicy.TRANSIENT_LOCAL if row.latched else DurabilityPolicy.VOLATILE
    return QoSProfile(depth=100, durability=durability)


def subscriptions(bench, node, namespace):
    """Relative topic names that a node subscribes, as the graph says."""
    found = bench.probe.node.get_subscriber_names_and_types_by_node(node, namespace)
    return {name.removeprefix(namespace).strip("/") for name, _ in found} - NOT_CHECKED


def all_subscriptions(bench):
    pairs = [(node, "/", topic) for node in ON_THE_BENCH for topic in subscriptions(bench, node, "/")]
    return [
        *pairs,
        *(("sim_bridge", "/simulated", topic) for topic in subscriptions(bench, "sim_bridge", "/simulated")),
    ]


def attack(bench, namespace, topic):
    """Every bad message there is, in bursts that a queue can hold."""
    row = TYPES[topic]
    samples = bench.good[topic] or [row.type()]
    publisher = bench.offender.node.create_publisher(row.type, f"{namespace}/{topic}".replace("//", "/"), _latched(row))
    bench.offender.wait_until(publisher.get_subscription_count, what=f"readers of {topic}")
    for index, message in enumerate(malformed(samples[-1])):
        publisher.publish(message)
        if index % BURST == 0:
            bench.probe.spin(0.005)


def told(bench):
    """Keys of all rejections in the newest words of each node: ``node: topic: reason (from sender)``."""
    return {
        f"{status.name.partition(': ')[0]}: {value.key}"
        for messages in bench.diagnostics
        for message in messages
        for status in message.status
        if status.name.endswith(": inputs")
        for value in status.values
    }


def test_every_subscription_of_every_node_is_in_the_contract(bench):
    seen = {topic for _, _, topic in all_subscriptions(bench)}
    assert seen <= set(TYPES)
    assert seen >= {topic for name in ON_THE_BENCH for topic in TABLE[name].subscribes}


def test_the_robot_drives_on_the_bench(bench):
    drive_off(bench)


def test_malformed_messages_are_survived_and_told_with_topic_and_offender(bench):
    pairs = all_subscriptions(bench)
    expected = {(node, namespace, topic) for node, namespace, topic in pairs if topic not in HARMLESS}

    def missing():
        keys = [key for key in told(bench) if OFFENDER in key]
        return {entry for entry in expected if not any(key.startswith(f"{entry[0]}: {entry[2]}: ") for key in keys)}

    # What the offender puts on cmd_vel of the bench cannot be told from what the arbiter lets through: last.
    for namespace, topic in sorted({pair[1:] for pair in pairs} - {("/", "cmd_vel")}):
        attack(bench, namespace, topic)
    for message in bench.good["cmd_vel"]:
        assert_permitted(message.twist)
    attack(bench, "/", "cmd_vel")
    # Publishers are remembered for a while: whose first word was rejected too soon to be known speaks again.
    for _ in range(ROUNDS):
        bench.probe.spin(1.5)
        for namespace, topic in sorted({entry[1:] for entry in missing()}):
            attack(bench, namespace, topic)
    bench.probe.spin(1.5)
    assert not missing()
    for process in bench.processes:
        assert process.is_running
        assert "Traceback" not in process.output


def test_after_the_attack_the_robot_drives_again(bench):
    bench.base.forget()
    drive_off(bench)


def test_a_clock_that_jumps_back_stops_the_robot_until_everybody_is_in_the_new_time(bench):
    told_before = len(bench.good["safety/state"])
    bench.base.jump(-JUMP_S)
    drive_off(bench)
    fresh = [message for message in bench.base.commands if stamp_ns(message) <= bench.base.stamp_ns]
    assert any(state.reason == "clock jumped back" for state in bench.good["safety/state"][told_before:])
    for message in fresh:
        assert_permitted(message.twist)


def drive_off(bench):
    """Let time go on until the robot drives by fresh commands; the player holds the start for up to two seconds."""
    for _ in range(MOST_SECONDS):
        bench.base.run(1.0)
        newest = bench.base.commands[-1] if bench.base.commands else TwistStamped()
        if newest.twist.linear.x > 0.1 and abs(stamp_ns(newest) - bench.base.stamp_ns) < 0.2e9:
            return
    raise AssertionError(f"after {MOST_SECONDS} s the newest command is {newest}")


def assert_permitted(twist):
    limits = ROBOT.limits
    assert limits.speed_min_mps - 1e-9 <= twist.linear.x <= limits.speed_max_mps + 1e-9
    assert abs(twist.angular.z) <= limits.yaw_rate_max_radps + 1e-9
