"""The bringup with the real graph: a whole run, and nodes that die."""

import json
import os
import signal
from pathlib import Path

import numpy as np
import pytest
from nav_msgs.msg import Odometry
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

from tracked_report.run_record import RunRecord

RUN_LIMIT_S = 100.0
RECORDED = {
    "single": {"odometry": 1 / 60, "truth": 1 / 60, "acceleration": 1 / 60, "upper_status": 1 / 5, "cmd_vel": 1 / 30},
    "double": {"odometry": 1 / 60, "slip": 1 / 60, "tracks": 1 / 60, "lower_status": 1 / 30, "cmd_vel": 1 / 30},
}


@pytest.fixture
def bringup(start_node, tmp_path):
    """``bringup(SCENARIO, ...)`` starts it with its output below the test's folder."""

    def start(*arguments):
        return start_node("bringup", *arguments, TRACKED_OUT=str(tmp_path / "out"))

    return start


def processes_of(folder: Path) -> dict[str, int]:
    """Node processes whose parameter file lies below ``folder``, by name."""
    found = {}
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            words = (entry / "cmdline").read_bytes().decode(errors="replace").split("\0")
        except OSError:
            continue
        found |= {
            Path(word).stem: int(entry.name) for word in words if word.startswith(str(folder)) and ".yaml" in word
        }
    return found


def largest_gap_s(record: RunRecord, channel: str) -> float:
    return float(np.max(np.diff(record.channel(channel).stamps_ns))) * 1e-9


def test_a_comparison_leaves_whole_records_a_report_and_no_process(bringup, tmp_path):
    process = bringup("compare", "duration_s:=4", "seed:=11")
    assert process.wait(RUN_LIMIT_S) == 0, process.output
    assert processes_of(tmp_path) == {}
    folder = tmp_path / "out" / "demo"
    for variant, channels in RECORDED.items():
        record = RunRecord.load(folder / f"{variant}.npz")
        for channel, period_s in channels.items():
            assert largest_gap_s(record, channel) < 1.1 * period_s, f"{variant} {channel}"
            assert record.channel(channel).stamps_ns[-1] > 3.7e9, f"{variant} {channel}"
        assert record.meta.variant == variant and record.meta.scene
        logs = {log.stem for log in (folder / "logs" / variant).glob("*.log")}
        assert logs == {"simulator", "control", "planning", "safety", "recording"}
    metrics = json.loads((folder / "metrics.json").read_text())
    assert metrics["name"] == "demo" and metrics["seed"] == 11
    assert {"single.estimated.rms_y_m", "double.estimated.rms_y_m"} <= metrics["values"].keys()
    assert "<html" in (folder / "report.html").read_text()
    assert "RMS y (m)" in process.output and str(folder / "report.html") in process.output


def test_a_fault_begins_at_its_instant_and_a_refused_one_ends_the_run(bringup, tmp_path):
    fault = "faults:=[{at_s: 1.0, kind: bias, target: %s, value: 0.2, duration_s: 0.5}]"
    process = bringup("idle", "duration_s:=2", "nodes.recorder:=true", fault % "tracks")
    assert process.wait(RUN_LIMIT_S) == 0, process.output
    tracks = RunRecord.load(tmp_path / "out" / "idle" / "double.npz").channel("tracks")
    biased = tracks.stamps_ns[np.abs(tracks.values[:, 2]) > 0.1]
    assert len(biased) == 30 and biased[0] == 10**9
    process = bringup("idle", fault % "left_track")
    assert process.wait(RUN_LIMIT_S) == 2
    assert "fault bias of left_track is refused: sensor must be one of tracks, imu, scan" in process.output
    assert processes_of(tmp_path) == {}


def test_a_node_that_may_come_back_does_and_an_idle_run_ends_well(bringup, tmp_path, probe):
    process = bringup("idle", "--grouping", "separate")
    odom = probe.collect(Odometry, "odom")
    probe.wait_until(lambda: odom, timeout_s=RUN_LIMIT_S, what="odometry")
    first = processes_of(tmp_path)["description"]
    os.kill(first, signal.SIGKILL)
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    words = probe.collect(String, "robot_description", latched)
    probe.wait_until(
        lambda: words and processes_of(tmp_path).get("description", first) != first,
        timeout_s=RUN_LIMIT_S,
        what="the description by another process",
    )
    assert "[description] ended (signal 9): started again, 1 of 3" in process.output
    assert process.stop(signal.SIGINT) == 0
    assert processes_of(tmp_path) == {}


def test_a_node_that_cannot_start_is_named_with_its_reason(bringup, tmp_path):
    process = bringup("track", "reference.parameters.speed_mps:=3.0")
    assert process.wait(RUN_LIMIT_S) == 1
    assert "planning ended (exit code 2)" in process.output and "needs a speed of" in process.output
    assert processes_of(tmp_path) == {}
