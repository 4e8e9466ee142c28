"""The whole graph over DDS: processor load, misses and latency in real time, and how fast lock-step runs.

Processor load is that of all nodes, simulator and recorder included, while the robot is commanded: processor
seconds per simulated second, so that a machine too busy for real time does not flatter it. The bringup that
watches is stated apart. Latency is the wall time from the publication of the clock at the odometry's stamp, sensing
and estimation included, to that of the command that answers it, by the times that DDS notes at the publishers.
Three runs, the real-time ones with the default grouping and with one process per node.
"""

import argparse
import os
import signal
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import rclpy
from geometry_msgs.msg import TwistStamped
from rclpy.context import Context
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rosgraph_msgs.msg import Clock

from tracked_bringup.domains import run_domain
from tracked_report.metrics.timing import loop_metrics
from tracked_report.results import output_folder, write_metrics
from tracked_report.run_record import RunRecord

ROOT = Path(__file__).resolve().parents[1]
SEED = 1
SECONDS, QUICK_SECONDS = 20.0, 8.0
"""Simulated time of each run."""
SETTLED_S = 2.0  # after the first command
SAMPLE_EVERY_S = 0.2
LIMIT_S = 180.0
QUEUE = 2000  # more than comes between two samples
TICKS_PER_SECOND = os.sysconf("SC_CLK_TCK")


@dataclass(frozen=True, slots=True)
class Load:
    """Processor seconds used so far, at a monotonic wall time: of every node process by name, and of the bringup."""

    wall_s: float
    nodes: dict[str, float]
    bringup_s: float


def processor_s(pid: int) -> float:
    """Processor time of a process, 0 once it is gone."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12])) / TICKS_PER_SECOND


def children(pid: int) -> dict[str, int]:
    """Node processes of a bringup: parameter file of each, which is named after it, to process id."""
    found = {}
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        for child in task.read_text().split():
            try:
                words = Path(f"/proc/{child}/cmdline").read_text().split("\0")
            except OSError:
                continue
            files = [Path(word).stem for word in words if word.endswith(".yaml")]
            if files:
                found[files[0]] = int(child)
    return found


class Stopwatch:
    """Hears clock and commands of a run, taken without an executor, which would cost more than the measurement."""

    def __init__(self, domain: int) -> None:
        self._context = Context()
        rclpy.init(args=[], context=self._context, domain_id=domain)
        self._node = Node("stopwatch", context=self._context, start_parameter_services=False)
        create = self._node.create_subscription
        self._clock = create(Clock, "clock", lambda _: None, QoSProfile(depth=QUEUE))
        self._command = create(TwistStamped, "cmd_vel", lambda _: None, QoSProfile(depth=QUEUE))
        self._clock_ns: dict[int, int] = {}
        self._command_ns: dict[int, int] = {}

    def close(self) -> None:
        """Leave the graph."""
        self._node.destroy_node()
        rclpy.shutdown(context=self._context)

    def refresh(self) -> None:
        """Take what has come: physical stamp -> time of publication."""
        for subscription, published in ((self._clock, self._clock_ns), (self._command, self._command_ns)):
            with subscription.handle:
                while (taken := subscription.handle.take_message(subscription.msg_type, False)) is not None:
                    message, information = taken
                    stamp = message.clock if subscription is self._clock else message.header.stamp
                    published.setdefault(stamp.sec * 10**9 + stamp.nanosec, information["source_timestamp"])

    def latencies_ms(self) -> np.ndarray:
        """From each instant to the command that answers it, once everything has settled."""
        begin_ns = min(self._command_ns) + int(SETTLED_S * 1e9)
        answered = [stamp for stamp in self._command_ns if stamp >= begin_ns and stamp in self._clock_ns]
        return np.array([self._command_ns[stamp] - self._clock_ns[stamp] for stamp in answered]) * 1e-6


def run(name: str, *arguments: str) -> tuple[RunRecord, list[Load], np.ndarray]:
    """One run of the bringup, its load sampled all the while, and its latencies (ms).

    Raises
    ------
    RuntimeError: with the output of the bringup, if it fails.
    """
    command = [str(ROOT / "run"), "bringup", "track", *arguments, "--name", f"graph_{name}"]
    loads: list[Load] = []
    with run_domain() as domain:
        stopwatch = Stopwatch(domain)
        environment = {**os.environ, "ROS_DOMAIN_ID": str(domain)}
        with subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment
        ) as process:
            deadline_s = time.monotonic() + LIMIT_S
            while process.poll() is None:
                pids = children(process.pid)
                used = {node: processor_s(pid) for node, pid in pids.items()}
                loads.append(Load(time.monotonic(), used, processor_s(process.pid)))
                stopwatch.refresh()
                time.sleep(SAMPLE_EVERY_S)
                if time.monotonic() > deadline_s:
                    process.send_signal(signal.SIGINT)
            output = process.stdout.read() if process.stdout else ""
        latencies_ms = stopwatch.latencies_ms()
        stopwatch.close()
    if process.returncode:
        raise RuntimeError(f"{' '.join(command)} ended with {process.returncode}:\n{output}")
    return RunRecord.load(output_folder() / f"graph_{name}" / "double.npz"), loads, latencies_ms


def window(record: RunRecord, loads: list[Load]) -> tuple[Load, Load]:
    """First and last sample while the robot was commanded and everything had settled."""
    arrivals = record.channel("cmd_vel").arrivals_s
    inside = [load for load in loads if arrivals[0] + SETTLED_S <= load.wall_s <= arrivals[-1]]
    return inside[0], inside[-1]


def cores(record: RunRecord, loads: list[Load]) -> tuple[dict[str, float], float]:
    """Processor seconds per simulated second of every node process, and of the bringup."""
    first, last = window(record, loads)
    odometry = record.channel("odometry")
    begin_s, end_s = np.interp([first.wall_s, last.wall_s], odometry.arrivals_s, odometry.stamps_ns * 1e-9)
    seconds = float(end_s - begin_s)
    nodes = {name: (last.nodes[name] - first.nodes[name]) / seconds for name in first.nodes if name in last.nodes}
    return nodes, (last.bringup_s - first.bringup_s) / seconds


def real_time_factor(record: RunRecord) -> float:
    """Simulated over wall time while the robot was commanded."""
    commands = record.channel("cmd_vel")
    return float(commands.stamps_ns[-1] - commands.stamps_ns[0]) * 1e-9 / float(np.ptp(commands.arrivals_s))


def main() -> None:
    """Measure, print a table and write the metrics."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="shorter runs")
    seconds = QUICK_SECONDS if parser.parse_args().quick else SECONDS
    common = (f"duration_s:={seconds}", f"seed:={SEED}", "world:=step", "reference.parameters:={length_m: 6.0}")
    values: dict[str, float] = {}
    for grouping, label in (("default", "grouped"), ("separate", "one_per_node")):
        record, loads, latencies_ms = run(label, *common, "time:=paced", "--grouping", grouping)
        nodes, bringup = cores(record, loads)
        values[f"graph.cores_{label}"] = sum(nodes.values())
        values[f"graph.{label}.cores_bringup"] = bringup
        values |= {f"graph.{label}.cores_{name}": load for name, load in nodes.items()}
        values[f"graph.{label}.real_time_factor"] = real_time_factor(record)
        values[f"graph.{label}.odometry_to_command_median_ms"] = float(np.median(latencies_ms))
        values[f"graph.{label}.odometry_to_command_p99_ms"] = float(np.percentile(latencies_ms, 99))
        ticks = loop_metrics(record, "lower_status", "lower").values
        values |= {f"graph.{label}.{key}": value for key, value in ticks.items()}
    record, _, _ = run("lock_step", *common, "time:=lock_step")
    values["graph.lock_step_real_time_factor"] = real_time_factor(record)
    values["graph.lock_step.lower_missed_percent"] = loop_metrics(record, "lower_status", "lower").values[
        "lower_missed_percent"
    ]
    for key in ("lower_missed_percent", "odometry_to_command_median_ms", "odometry_to_command_p99_ms"):
        values[f"graph.{key}"] = values[f"graph.grouped.{key}"]
    for key, value in values.items():
        print(f"{key:<55}{value:>10.3f}")
    print(write_metrics("graph", values, seed=SEED))


if __name__ == "__main__":
    main()
