"""One process of nodes, run for real: signals, exit codes, bad starts."""

import os
import signal
import subprocess
import sys
from contextlib import contextmanager

import pytest

LIMIT_S = 30.0
PRELUDE = """
import sys
from geometry_msgs.msg import TwistStamped
from node_kit import Parameter, ParameterTable, StackNode, qos, run
from node_kit.conversions import command_to_message
from tracked_types import Twist2, VelocityCommand

def say(*words):
    print(*words, flush=True)

class Driver(StackNode):
    "Drives until it is told to stop."
    NAME = "driver"
    PARAMETERS = ParameterTable(Parameter("gain", 1.0, "Gain of it", low=0.0, high=5.0))
    def __init__(self):
        super().__init__()
        self.commands = self.publish_typed(TwistStamped, "cmd_vel", command_to_message, qos.COMMAND)
        self.count = 0
        self.every_wall(0.01, self.tick)
    def tick(self):
        self.count += 1
        if self.count == 3:
            say(self.get_name(), "drives")
        self.work()
    def work(self):
        pass
    def safe_stop(self):
        self.commands.publish(VelocityCommand(0, Twist2(0.0, 0.0)))
        say(self.get_name(), "stopped")
"""


@contextmanager
def started(script, *arguments, **environment):
    """The script in a Python of its own that finds nobody else; killed with the block at the latest."""
    environment = {
        **os.environ,
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF",
        "PYTHONPATH": os.pathsep.join(sys.path),
        **environment,
    }
    process = subprocess.Popen(
        [sys.executable, "-c", PRELUDE + script, *arguments],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=environment,
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait()
        process.stdin.close()
        process.stdout.close()
        process.stderr.close()


def finished(process):
    """Exit code, output and errors of a process that ends by itself."""
    output, errors = process.communicate(timeout=LIMIT_S)
    return process.returncode, output, errors


def wait_for(process, line):
    """Read the output up to a line."""
    for text in process.stdout:
        if text.strip() == line:
            return
    pytest.fail(f"{line!r} never came: {process.stderr.read()}")


RUN = "sys.exit(run(Driver))"


@pytest.mark.parametrize(
    ("executor", "number"), [("events", signal.SIGINT), ("events", signal.SIGTERM), ("single", signal.SIGTERM)]
)
def test_signal_stops_what_moves_and_exits_cleanly(executor, number):
    with started(RUN, NODE_KIT_EXECUTOR=executor) as process:
        wait_for(process, "driver drives")
        process.send_signal(number)
        assert finished(process) == (0, "driver stopped\n", "")


def test_second_signal_during_the_stop_is_ignored():
    script = """
class Slow(Driver):
    def safe_stop(self):
        say("stopping")
        sys.stdin.readline()
        super().safe_stop()
sys.exit(run(Slow))
"""
    with started(script) as process:
        wait_for(process, "driver drives")
        process.send_signal(signal.SIGINT)
        wait_for(process, "stopping")
        process.send_signal(signal.SIGINT)
        process.send_signal(signal.SIGTERM)
        assert finished(process)[:2] == (0, "driver stopped\n")


def test_all_nodes_of_a_process_are_stopped_even_if_one_fails_to():
    script = """
class Other(Driver):
    NAME = "other"
    def safe_stop(self):
        raise RuntimeError("cannot stop")
sys.exit(run(Other, Driver))
"""
    with started(script) as process:
        wait_for(process, "driver drives")
        process.send_signal(signal.SIGINT)
        code, output, errors = finished(process)
    assert code == 0
    assert "driver stopped" in output
    assert "cannot stop" in errors


def test_failing_callback_is_named_and_served_on():
    script = """
class Failing(Driver):
    def work(self):
        if self.count == 2:
            raise KeyError("lost")
sys.exit(run(Failing))
"""
    with started(script) as process:
        wait_for(process, "driver drives")
        process.send_signal(signal.SIGINT)
        code, output, errors = finished(process)
    assert (code, output) == (0, "driver stopped\n")
    assert "Driver.tick failed: KeyError: 'lost'" in errors


def test_node_may_end_the_process_with_a_code_and_a_reason():
    script = """
class Finishing(Driver):
    def work(self):
        self.request_exit(7, "no command for 10 s")
sys.exit(run(Finishing))
"""
    with started(script) as process:
        code, output, errors = finished(process)
    assert (code, output) == (7, "driver stopped\n")
    assert "no command for 10 s" in errors


def test_idle_work_runs_between_callbacks():
    script = """
class Busy(Driver):
    steps = 0
    def idle_work(self):
        self.steps += 1
        if self.steps > 1000 and self.count > 3:
            self.request_exit(0, "done")
        return 0.0
sys.exit(run(Busy))
"""
    with started(script) as process:
        code, output, _ = finished(process)
    assert code == 0
    assert output == "driver drives\ndriver stopped\n"


def test_idle_work_that_fails_is_named_and_leaves_the_callbacks_running():
    script = """
class Broken(Driver):
    def idle_work(self):
        raise KeyError("lost")
sys.exit(run(Broken))
"""
    with started(script) as process:
        wait_for(process, "driver drives")
        process.send_signal(signal.SIGINT)
        code, output, errors = finished(process)
    assert (code, output) == (0, "driver stopped\n")
    assert "Broken.idle_work failed: KeyError: 'lost'" in errors


@pytest.mark.parametrize(
    ("arguments", "code", "sentence"),
    [
        (("--ros-args", "-p", "gain:=9.0"), 2, "cannot start: parameter gain must be at most 5, got 9.0"),
        (("--ros-args", "--params-file", "/no/such.yaml"), 2, "/no/such.yaml"),
    ],
)
def test_bad_start_is_one_clear_line(arguments, code, sentence):
    with started(RUN, *arguments) as process:
        actual, output, errors = finished(process)
    assert (actual, output) == (code, "")
    assert sentence in errors
    assert "Traceback" not in errors


@pytest.mark.parametrize(
    ("body", "code", "sentence"),
    [
        ("raise OSError('map.yaml: cannot be read')", 1, "cannot start: map.yaml: cannot be read"),
        ("raise ValueError('Settings.gain must be less than Settings.limit')", 2, "must be less than"),
        ("{}['wheel']", 1, "KeyError: 'wheel' (<string>:"),
    ],
)
def test_node_that_cannot_be_made_says_why_and_the_others_are_stopped(body, code, sentence):
    script = f"""
class Broken(StackNode):
    NAME = "broken"
    def __init__(self):
        super().__init__()
        {body}
sys.exit(run(Driver, Broken))
"""
    with started(script) as process:
        actual, output, errors = finished(process)
    assert (actual, output) == (code, "driver stopped\n")
    assert sentence in errors
    assert "Traceback" not in errors


def test_debugging_shows_the_traceback_of_a_bad_start():
    with started(RUN, "--ros-args", "-p", "gain:=9.0", NODE_KIT_DEBUG="1") as process:
        assert "Traceback" in finished(process)[2]


def test_signal_while_a_node_is_being_made_ends_the_process():
    script = """
class Endless(StackNode):
    NAME = "endless"
    def __init__(self):
        super().__init__()
        say("waiting")
        while True:
            pass
sys.exit(run(Driver, Endless))
"""
    with started(script) as process:
        wait_for(process, "waiting")
        process.send_signal(signal.SIGTERM)
        assert finished(process) == (0, "driver stopped\n", "")
