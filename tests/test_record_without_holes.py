"""A recorder that gets no processor for a while misses nothing of a lock-step run."""

import signal
import time

import numpy as np
from nav_msgs.msg import Odometry

from tests.support.domains import own_domain
from tests.support.graph_process import GraphProcess
from tests.support.listener import own_listener
from tracked_report.run_record import RunRecord

MISSED_MEANWHILE = 150  # messages of odometry: two and a half seconds of the run
LOOK_EVERY_S, LIMIT_S = 0.005, 60.0
ARGUMENTS = ("track", "time:=lock_step", "duration_s:=8", "--grouping", "separate", "--name", "halted")


def wait_for_more(heard, count, listener, graph):
    wanted, deadline_s = len(heard) + count, time.monotonic() + LIMIT_S
    while len(heard) < wanted:
        assert not graph.ends_within(LOOK_EVERY_S) and time.monotonic() < deadline_s, graph.output
        listener.refresh()


def test_a_recorder_that_was_halted_for_a_part_of_the_run_has_every_sample(tmp_path):
    with own_domain() as domain, own_listener(domain) as listener:
        heard = listener.hear(Odometry, "odom")
        graph = GraphProcess(domain, tmp_path, *ARGUMENTS)
        try:
            wait_for_more(heard, 30, listener, graph)
            graph.signal_child("recorder", signal.SIGSTOP)
            wait_for_more(heard, MISSED_MEANWHILE, listener, graph)
            graph.signal_child("recorder", signal.SIGCONT)
            assert graph.wait(LIMIT_S) == 0, graph.output
        finally:
            graph.end()
    record = RunRecord.load(graph.folder / "halted" / "double.npz")
    for channel in ("odometry", "truth", "tracks", "slip"):
        periods_s = np.diff(record.channel(channel).stamps_ns) * 1e-9
        assert len(periods_s) > 240 and periods_s.max() < 1.5 / 60, channel
