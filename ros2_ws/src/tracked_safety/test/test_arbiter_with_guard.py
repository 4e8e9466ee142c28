"""The arbiter with its collision guard: what passes of anybody's command, and when it stops for good."""

import contextlib
import math
from dataclasses import replace
from functools import partial
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tracked_description import load_robot
from tracked_safety import (
    SOURCES,
    ArbiterSettings,
    CollisionGuard,
    CommandArbiter,
    CommandRefused,
    GuardSettings,
    ScanRefused,
)
from tracked_safety.bench_inputs import BEAMS, odometry, ranges_of, scan
from tracked_types import ArbiterMode, GuardAction, PeriodGrid, Pose2, Twist2, VelocityCommand

ROBOT = load_robot()
SETTINGS = ArbiterSettings.from_robot(ROBOT)
GUARD = GuardSettings.from_robot(ROBOT)
FRONT_M = GUARD.footprint.front_m
CONTROL, ODOMETRY, LIDAR = PeriodGrid(30), PeriodGrid(60), PeriodGrid(10)
FAST = Twist2(0.5, 0.0)


class Bench:
    """A robot that obeys perfectly, 0.1 s late, in front of a wall of posts at ``wall_m`` or in the open."""

    def __init__(self, *, wall_m=np.inf, lock_step=False, guard=GUARD):
        self.arbiter = CommandArbiter(SETTINGS, CollisionGuard(guard), lock_step=lock_step)
        self.wall_m, self.has_lidar = wall_m, True
        self.x_m, self.sent, self.tick_index = 0.0, [], 0
        self.wanted = {"nav": FAST}

    @property
    def gap_m(self):
        return self.wall_m - self.x_m - FRONT_M

    def scan(self, stamp_ns):
        posts = [] if self.wall_m == np.inf else [(self.wall_m - self.x_m, y) for y in np.linspace(-0.3, 0.3, 31)]
        return scan(stamp_ns, ranges_of(posts, GUARD.lidar))

    def run(self, seconds):
        for _ in range(round(60 * seconds)):
            self.tick()
        return self

    def tick(self):
        index = self.tick_index
        stamp_ns = ODOMETRY.stamp_ns(index)
        delayed = [sent for sent in self.sent if sent.stamp_ns <= stamp_ns - 10**8]
        speed = delayed[-1].twist.speed_mps if delayed else 0.0
        self.x_m += speed / 60.0
        if index % 6 == 0 and index >= 6 and self.has_lidar:
            self.take(self.arbiter.add_scan(self.scan(LIDAR.stamp_ns(index // 6 - 1))))
        self.take(self.arbiter.add_odometry(odometry(index / 60, Pose2(self.x_m, 0.0, 0.0), Twist2(speed, 0.0))))
        if index % 2 == 0:
            for source, twist in self.wanted.items():
                self.take(self.arbiter.offer(source, VelocityCommand(stamp_ns, twist)))
        self.tick_index += 1

    def take(self, command):
        if command is not None:
            self.sent.append(command)


def speeds(bench):
    return [sent.twist.speed_mps for sent in bench.sent]


def test_commands_pass_untouched_where_nothing_is_near():
    plain, guarded = CommandArbiter(SETTINGS), Bench().run(2.0)
    expected = [plain.offer("nav", VelocityCommand(CONTROL.stamp_ns(index), FAST)) for index in range(60)]
    first = next(index for index, sent in enumerate(guarded.sent) if sent.twist.speed_mps > 0.0)
    rest = [sent.twist.speed_mps for sent in expected[: len(guarded.sent) - first]]
    assert speeds(guarded)[first:] == pytest.approx(rest)
    assert first <= 4
    assert guarded.arbiter.state.guard is GuardAction.PASSING


@pytest.mark.parametrize("source", SOURCES)
def test_every_source_stops_before_a_wall_within_ordinary_braking(source):
    bench = Bench(wall_m=2.5)
    bench.wanted = {source: FAST}
    bench.run(8.0)
    assert bench.gap_m > 0.0
    assert bench.gap_m < 0.045
    assert bench.sent[-1].twist == Twist2(0.0, 0.0)
    steps = [before - after for before, after in pairwise(speeds(bench))]
    hard = [step for step in steps if step > SETTINGS.limits.braking_mps2 / 30.0 * 1.001]
    assert hard == [GUARD.crawl_mps], "a crawl ends at once"
    state = bench.arbiter.state
    assert state.guard is GuardAction.HOLDING and "obstacle" in state.guard_reason
    assert state.mode is ArbiterMode.FORWARDING and state.obstacle_m == 0.0


def test_for_a_wall_thrown_in_it_brakes_as_hard_as_the_belts_can_within_the_same_instant_as_the_scan():
    bench = Bench().run(2.0)
    assert bench.sent[-1].twist == FAST
    bench.wall_m = bench.x_m + FRONT_M + 0.12
    count = len(bench.sent)
    bench.run(1.0)
    slower = next(sent for sent in bench.sent[count:] if sent.twist != FAST)
    assert (slower.stamp_ns - LIDAR.stamp_ns(19)) <= 0.12e9
    steps = [before - after for before, after in pairwise(speeds(bench)[count - 1 :])]
    assert max(steps) == pytest.approx(ROBOT.tracks.acceleration_limit_mps2 / 30.0)
    assert bench.gap_m > 0.0


def test_a_scan_between_two_commands_replaces_what_was_sent_under_its_stamp():
    bench = Bench().run(2.0)
    bench.wall_m = bench.x_m + FRONT_M + 0.1
    newest = bench.sent[-1]
    replaced = bench.arbiter.add_scan(bench.scan(ODOMETRY.stamp_ns(bench.tick_index - 1) - 10**8 + 1))
    assert replaced is not None and replaced.stamp_ns == newest.stamp_ns
    assert replaced.twist.speed_mps < newest.twist.speed_mps


def test_a_source_that_is_slower_than_the_control_period_is_judged_between_its_commands():
    bench = Bench().run(2.0)
    bench.wanted = {}
    bench.wall_m = bench.x_m + FRONT_M + 0.16
    bench.run(0.19)
    assert bench.arbiter.state.mode is ArbiterMode.FORWARDING
    assert speeds(bench)[-1] < 0.4
    now_ns = ODOMETRY.stamp_ns(bench.tick_index - 1)
    assert now_ns - bench.sent[-1].stamp_ns <= 0.11e9, "the base would refuse what is older than 0.2 s"


def test_without_a_first_scan_the_robot_stands_and_says_why():
    bench = Bench()
    bench.has_lidar = False
    bench.run(1.0)
    assert set(speeds(bench)) == {0.0}
    assert bench.arbiter.state.guard is GuardAction.BLIND and bench.arbiter.state.guard_reason == "no scan yet"
    assert bench.arbiter.state.mode is ArbiterMode.FORWARDING


def test_a_lidar_lost_in_motion_stops_the_robot_within_braking_limits_and_a_hiccup_heals():
    bench = Bench().run(2.0)
    lost_ns = CONTROL.stamp_ns(60)
    bench.has_lidar = False
    bench.run(1.5)
    first = next(sent for sent in bench.sent if sent.stamp_ns > lost_ns and sent.twist != FAST)
    assert first.stamp_ns - lost_ns <= 0.3e9
    steps = [before - after for before, after in pairwise(speeds(bench))]
    assert max(steps) <= SETTINGS.limits.braking_mps2 / 30.0 * 1.001
    assert bench.arbiter.state.guard_reason == "the scan is older than 0.3 s"
    bench.has_lidar = True
    bench.run(1.0)
    assert bench.sent[-1].twist == FAST


def test_a_lidar_that_stays_away_latches_the_stop_until_it_is_back_and_released():
    bench = Bench().run(1.0)
    bench.has_lidar = False
    bench.run(3.0)
    state = bench.arbiter.state
    assert state.mode is ArbiterMode.LATCHED_STOP and state.reason == "no scan for 2 s"
    assert bench.arbiter.release() == "there is no fresh scan yet"
    bench.has_lidar = True
    bench.run(1.0)
    assert bench.sent[-1].twist == Twist2(0.0, 0.0)
    assert bench.arbiter.release() is None
    assert bench.run(1.0).sent[-1].twist == FAST


def test_refused_scans_do_not_keep_the_robot_going():
    bench = Bench().run(1.0)
    bench.has_lidar = False
    for _ in range(60):
        bench.tick()
        blank = scan(ODOMETRY.stamp_ns(bench.tick_index - 1) - 10**8, np.full(BEAMS, np.nan))
        with pytest.raises(ScanRefused, match="too few beams"):
            bench.arbiter.add_scan(blank)
    assert bench.sent[-1].twist == Twist2(0.0, 0.0)


def test_a_clock_that_jumps_back_forgets_the_scan():
    bench = Bench().run(2.0)
    bench.arbiter.add_odometry(odometry(0.5))
    bench.arbiter.offer("nav", VelocityCommand(CONTROL.stamp_ns(16), FAST))
    assert bench.arbiter.state.guard_reason == "no scan yet"


def test_in_lock_step_a_command_waits_for_its_odometry_and_for_the_scan_that_is_due():
    bench = Bench(lock_step=True).run(1.0)
    at = bench.tick_index
    stamp_ns = ODOMETRY.stamp_ns(at)
    assert at % 6 == 0, "a scan is due"
    assert bench.arbiter.offer("nav", VelocityCommand(stamp_ns, FAST)) is None
    assert bench.arbiter.add_odometry(odometry(at / 60, Pose2(bench.x_m, 0.0, 0.0))) is None
    assert bench.arbiter.is_waiting
    passed = bench.arbiter.add_scan(bench.scan(stamp_ns - 10**8))
    assert passed is not None and passed.stamp_ns == stamp_ns
    assert not bench.arbiter.is_waiting


def test_in_lock_step_the_order_of_arrival_makes_no_difference():
    def driven(order):
        bench = Bench(wall_m=1.2, lock_step=True)
        arbiter = bench.arbiter
        for index in range(240):
            stamp_ns = ODOMETRY.stamp_ns(index)
            pose = Pose2(index / 200, 0.0, 0.1 * math.sin(index / 20))
            inputs = {"odometry": partial(arbiter.add_odometry, odometry(index / 60, pose))}
            if index % 2 == 0 and index >= 10:
                inputs["command"] = partial(arbiter.offer, "nav", VelocityCommand(stamp_ns, FAST))
            if index % 6 == 0 and index >= 6:
                bench.x_m = (index - 3) / 200
                inputs["scan"] = partial(arbiter.add_scan, bench.scan(LIDAR.stamp_ns(index // 6 - 1)))
            for name in order:
                if name in inputs:
                    bench.take(inputs[name]())
        return [(sent.stamp_ns, sent.twist) for sent in bench.sent]

    first = driven(("odometry", "command", "scan"))
    assert min(twist.speed_mps for _, twist in first[30:]) < 0.2
    for order in (("scan", "odometry", "command"), ("command", "scan", "odometry")):
        assert driven(order) == first


def test_in_lock_step_a_scan_that_does_not_come_can_be_given_up():
    bench = Bench(lock_step=True).run(1.0)
    bench.has_lidar = False
    bench.tick()
    assert bench.arbiter.is_waiting
    assert bench.arbiter.stop_waiting() is not None
    bench.run(0.1)
    assert not bench.arbiter.is_waiting


def test_a_robot_that_was_put_too_close_may_only_go_back_and_at_a_crawl_at_first():
    bench = Bench(wall_m=FRONT_M + 0.03)
    bench.run(1.0)
    assert set(speeds(bench)) == {0.0}
    bench.wanted = {"teleop": Twist2(-0.4, 0.0)}
    bench.run(0.4)
    assert min(speeds(bench)) == pytest.approx(-GUARD.crawl_mps)
    bench.run(3.0)
    assert bench.sent[-1].twist.speed_mps == -0.4


@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_whatever_comes_the_base_gets_permitted_twists(data):
    arbiter = CommandArbiter(SETTINGS, CollisionGuard(replace(GUARD, approach_s=0.5)))
    now, sent = 60, []
    for _ in range(40):
        kind = data.draw(st.sampled_from(["odometry", "scan", *SOURCES]))
        now = max(now + data.draw(st.integers(-3, 3)), 0)
        stamp_ns = ODOMETRY.stamp_ns(now)
        with contextlib.suppress(CommandRefused, ScanRefused):
            if kind == "odometry":
                pose = Pose2(data.draw(st.floats(-1.0, 1.0)), 0.0, data.draw(st.floats(-3.0, 3.0)))
                sent.append(arbiter.add_odometry(odometry(now / 60, pose)))
            elif kind == "scan":
                sent.append(arbiter.add_scan(scan(stamp_ns, data.draw(st.lists(st.floats(width=32), max_size=8)))))
            else:
                twist = Twist2(data.draw(st.floats(-0.5, 0.6)), data.draw(st.floats(-1.5, 1.5)))
                sent.append(arbiter.offer(kind, VelocityCommand(stamp_ns, twist)))
    for output in filter(None, sent):
        assert SETTINGS.limits.excess(output.twist) <= 1.0 + 1e-9
