"""The whole graph over DDS: processor load, misses and latency in real time, and how fast lock-step runs.

Processor load is that of all nodes, simulator and recorder included, while the robot is commanded: processor
seconds per simulated second, so that a machine too busy for real time does not flatter it. The bringup that
watches is stated apart. Three runs, the real-time ones with the default grouping and with one process per node.
"""

import argparse
import os
import signal
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tracked_report.metrics.timing import latency_metrics, loop_metrics
from tracked_report.results import output_folder, write_metrics
from tracked_report.run_record import RunRecord

ROOT = Path(__file__).resolve().parents[1]
SEED = 1
SECONDS, QUICK_SECONDS = 20.0, 8.0
"""Simulated time of each run."""
SETTLED_S = 2.0  # after the first command
SAMPLE_EVERY_S = 0.2
LIMIT_S = 180.0
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


def run(name: str, *arguments: str) -> tuple[RunRecord, list[Load]]:
    """One run of the bringup, its load sampled all the while; raises RuntimeError with its output if it fails."""
    command = [str(ROOT / "run"), "bringup", "track", *arguments, "--name", f"graph_{name}"]
    loads: list[Load] = []
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        deadline_s = time.monotonic() + LIMIT_S
        while process.poll() is None:
            pids = children(process.pid)
            used = {node: processor_s(pid) for node, pid in pids.items()}
            loads.append(Load(time.monotonic(), used, processor_s(process.pid)))
            time.sleep(SAMPLE_EVERY_S)
            if time.monotonic() > deadline_s:
                process.send_signal(signal.SIGINT)
        output = process.stdout.read() if process.stdout else ""
    if process.returncode:
        raise RuntimeError(f"{' '.join(command)} ended with {process.returncode}:\n{output}")
    return RunRecord.load(output_folder() / f"graph_{name}" / "double.npz"), loads


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
        record, loads = run(label, *common, "time:=paced", "--grouping", grouping)
        nodes, bringup = cores(record, loads)
        values[f"graph.cores_{label}"] = sum(nodes.values())
        values[f"graph.{label}.cores_bringup"] = bringup
        values |= {f"graph.{label}.cores_{name}": load for name, load in nodes.items()}
        values[f"graph.{label}.real_time_factor"] = real_time_factor(record)
        for sheet in (loop_metrics(record, "lower_status", "lower"), latency_metrics(record)):
            values |= {f"graph.{label}.{key}": value for key, value in sheet.values.items()}
    record, _ = run("lock_step", *common, "time:=lock_step")
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
