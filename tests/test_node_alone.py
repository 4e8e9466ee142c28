"""Every node of the table in a process of its own: parameters as declared, and a polite end."""

import pty
import signal
import subprocess

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import ParameterType, ParameterValue
from rcl_interfaces.srv import DescribeParameters, GetParameters, SetParameters
from rclpy.parameter import parameter_value_to_python

from node_kit.common_parameters import COMMON_PARAMETERS
from tests.support.domains import own_domain
from tests.support.node_process import NodeProcess
from tests.support.probe import own_probe
from tracked_bringup.bags import BagWriter
from tracked_bringup.node_group import load_class
from tracked_bringup.node_table import load_node_table

TABLE = load_node_table().nodes
CLASSES = {name: load_class(entry.node_class) for name, entry in TABLE.items()}
NODES = pytest.mark.parametrize("name", TABLE)
NEEDED = {"record_file", "folder", "bag"}
TERMINAL = pty.openpty()[1]
START_LIMIT_S = 60.0  # where nothing is compiled yet, or everything else runs at the same time


def started(names, domain, folder, parameters):
    """One process per node, all at once."""
    return {
        name: NodeProcess(
            (TABLE[name].package, TABLE[name].executable, "--ros-args", *parameters(name)),
            folder / f"{name}.log",
            {"ROS_DOMAIN_ID": str(domain)},
            TERMINAL if name == "teleop_keyboard" else subprocess.DEVNULL,
        )
        for name in names
    }


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """A probe, what the nodes say of themselves, and their processes, started with nothing but their defaults."""
    folder = tmp_path_factory.mktemp("alone")
    needed = {
        "recorder": ("-p", f"record_file:={folder / 'record.npz'}"),
        "mcap_recorder": ("-p", f"folder:={folder / 'recorded'}"),
        "replay": ("-p", f"bag:={bag_of_an_hour(folder / 'bag')}"),
    }
    with own_domain() as domain, own_probe(domain) as probe:
        diagnostics = probe.collect(DiagnosticArray, "diagnostics", 100)
        processes = started(TABLE, domain, folder, lambda name: needed.get(name, ()))
        try:
            probe.wait_until(
                lambda: set(TABLE) <= set(probe.node.get_node_names()), timeout_s=START_LIMIT_S, what="all nodes"
            )
            yield probe, diagnostics, processes
        finally:
            for process in processes.values():
                process.end()


@pytest.fixture(scope="module")
def refused(tmp_path_factory):
    """Processes of nodes whose parameters cannot be used, and the names of these parameters."""
    folder = tmp_path_factory.mktemp("refused")
    bad = {name: {"frame_prefix": "3", **bad_choice(CLASSES[name].PARAMETERS)} for name in TABLE}
    with own_domain() as domain:
        processes = started(
            TABLE,
            domain,
            folder,
            lambda name: [word for key, value in bad[name].items() for word in ("-p", f"{key}:={value}")],
        )
        try:
            yield {name: (process, list(bad[name])) for name, process in processes.items()}
        finally:
            for process in processes.values():
                process.end()


def bag_of_an_hour(folder):
    """A recording that takes long to play."""
    bag = BagWriter(folder)
    bag.add_topic("/slow", "std_msgs/msg/Empty", "", "", [])
    for stamp_s in (0, 3600):
        bag.write("/slow", stamp_s * 10**9, bytes([0, 1, 0, 0, 0]))
    bag.close()
    return folder


def bad_choice(table):
    """A value outside the range or the choices of one of the node's own parameters, where one has any."""
    for parameter in table:
        if parameter.choices:
            return {parameter.name: "neither"}
        if parameter.high is not None:
            return {parameter.name: type(parameter.default)(10 * parameter.high + 1)}
    return {}


@NODES
def test_it_starts_with_its_defaults_and_shows_them(alone, name):
    probe, _, _ = alone
    parameters = [
        parameter for parameter in CLASSES[name].PARAMETERS + COMMON_PARAMETERS if parameter.name not in NEEDED
    ]
    asked = GetParameters.Request(names=[parameter.name for parameter in parameters])
    values = probe.call(GetParameters, f"{name}/get_parameters", asked).values
    shown = [parameter_value_to_python(value) for value in values]
    expected = [
        list(parameter.default) if isinstance(parameter.default, tuple) else parameter.default
        for parameter in parameters
    ]
    assert [list(value) if hasattr(value, "typecode") else value for value in shown] == expected


@NODES
def test_its_parameters_say_what_they_are_and_what_is_allowed(alone, name):
    probe, _, _ = alone
    parameters = list(CLASSES[name].PARAMETERS + COMMON_PARAMETERS)
    asked = DescribeParameters.Request(names=[parameter.name for parameter in parameters])
    descriptors = probe.call(DescribeParameters, f"{name}/describe_parameters", asked).descriptors
    for parameter, descriptor in zip(parameters, descriptors, strict=True):
        assert parameter.description in descriptor.description
        assert parameter.unit in descriptor.description
        assert descriptor.read_only is not parameter.live
        ranges = [*descriptor.floating_point_range, *descriptor.integer_range]
        assert bool(ranges) == (parameter.low is not None or parameter.high is not None)
        assert all(choice in descriptor.additional_constraints for choice in parameter.choices)


@NODES
def test_what_cannot_change_while_it_runs_is_refused_with_a_reason(alone, name):
    probe, _, _ = alone
    value = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value="other/")
    asked = SetParameters.Request(parameters=[ParameterMessage(name="frame_prefix", value=value)])
    result = probe.call(SetParameters, f"{name}/set_parameters", asked).results[0]
    assert not result.successful
    assert "frame_prefix" in result.reason


@NODES
def test_it_tells_how_it_is(alone, name):
    probe, diagnostics, _ = alone
    probe.wait_until(
        lambda: f"{name}: inputs" in {status.name for message in diagnostics for status in message.status},
        what=f"the diagnostics of {name}",
    )


@NODES
def test_being_told_to_end_is_no_failure(alone, name):
    _, _, processes = alone
    # Bringup ends its nodes by SIGINT, and its tests look at their exit codes; container engines send SIGTERM.
    assert processes[name].stop(signal.SIGTERM) == 0
    assert "Traceback" not in processes[name].output


@NODES
def test_bad_parameters_are_named_in_one_line(refused, name):
    process, parameters = refused[name]
    assert process.wait(START_LIMIT_S) == 2
    lines = [line for line in process.output.splitlines() if "cannot start" in line]
    assert len(lines) == 1, process.output
    assert all(f"parameter {parameter} " in lines[0] for parameter in parameters)
    assert "Traceback" not in process.output
