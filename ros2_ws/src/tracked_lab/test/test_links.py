"""Links: what arrives, when, in which order, and how a drive takes it."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from tracked_lab import drive
from tracked_lab.conditions import Conditions, Link, Links
from tracked_lab.links import NAMES, LinkScheduler
from tracked_report.metrics import run_metrics
from tracked_report.run_record import RunRecord
from tracked_report.scenario import Scenario

TICK_NS = 8_333_333
times = st.floats(0.0, 0.3)
link = st.builds(Link, latency_s=times, jitter_s=times, loss=st.floats(0.0, 1.0))
all_links = st.builds(Links, **dict.fromkeys(NAMES, link))
sends = st.lists(st.tuples(st.integers(0, 40), st.sampled_from(NAMES)), max_size=60)


def arrivals(links: Links, seed: int, sent: list[tuple[int, str]], ticks: int = 200) -> list[tuple[int, str, int]]:
    """Time, link and number of everything that arrives; ``sent``: tick and link of each item, in any order."""
    scheduler, arrived = LinkScheduler(links, seed), []
    for tick in range(ticks):
        scheduler.run_until(tick * TICK_NS)
        for number, (at, name) in enumerate(sent):
            if at == tick:
                scheduler.send(name, (name, number), lambda item: arrived.append((scheduler.now_ns, *item)))
    return arrived


@given(links=all_links, seed=st.integers(0, 2**32 - 1), sent=sends)
@settings(max_examples=60, deadline=None)
def test_deliveries_are_in_order_of_time_none_twice_none_early_none_later_than_jitter_allows(links, seed, sent):
    arrived = arrivals(links, seed, sent)
    assert [at for at, *_ in arrived] == sorted(at for at, *_ in arrived)
    numbers = [number for *_, number in arrived]
    assert len(set(numbers)) == len(numbers)
    for at, name, number in arrived:
        way, took_s = getattr(links, name), (at - sent[number][0] * TICK_NS) / 1e9
        assert way.latency_s - 1e-9 <= took_s <= way.latency_s + way.jitter_s + 1e-9
        assert way.loss < 1.0
    assert arrived == arrivals(links, seed, sent)


@given(latency_s=times, seed=st.integers(0, 99), sent=sends)
@settings(max_examples=30, deadline=None)
def test_without_jitter_the_latency_is_exact_and_equal_times_go_by_link_then_by_sequence(latency_s, seed, sent):
    links = Links(**dict.fromkeys(NAMES, Link(latency_s=latency_s)))
    arrived = arrivals(links, seed, sent)
    assert len(arrived) == len(sent)
    for at, _, number in arrived:
        assert at == sent[number][0] * TICK_NS + round(latency_s * 1e9)
    if round(latency_s * 1e9) > 0:
        order = [(at, NAMES.index(name), number) for at, name, number in arrived]
        assert order == sorted(order)


@given(loss=st.floats(0.05, 0.95), seed=st.integers(0, 99))
@settings(max_examples=20, deadline=None)
def test_the_share_that_gets_lost_is_the_one_asked_for(loss, seed):
    scheduler, arrived = LinkScheduler(Links(imu=Link(loss=loss)), seed), []
    for number in range(4000):
        scheduler.send("imu", number, arrived.append)
    deviation = np.sqrt(loss * (1.0 - loss) / 4000)
    assert 1.0 - len(arrived) / 4000 == pytest.approx(loss, abs=5.0 * deviation)


def test_one_links_settings_do_not_change_the_fate_of_what_takes_another():
    sent = [(tick, name) for tick in range(40) for name in ("imu", "command")]
    command = Link(latency_s=0.02, jitter_s=0.05, loss=0.3)

    def fates(**others):
        return [each for each in arrivals(Links(command=command, **others), 5, sent) if each[1] == "command"]

    assert fates() == fates(imu=Link(latency_s=0.1, loss=0.5))


def test_what_a_delivery_brings_about_is_sent_at_the_time_of_the_delivery():
    scheduler, seen = LinkScheduler(Links(imu=Link(latency_s=0.01), command=Link(latency_s=0.003)), 1), []
    scheduler.send("imu", 0, lambda _: scheduler.send("command", 0, lambda _: seen.append(scheduler.now_ns)))
    scheduler.run_until(10_000_000)
    assert seen == []
    scheduler.run_until(20_000_000)
    assert seen == [13_000_000]


@pytest.mark.parametrize("wrong", [{"loss": 1.5}, {"latency_s": -0.1}, {"jitter_s": float("nan")}, {"lag_s": 1.0}])
def test_a_link_that_cannot_be_is_refused_by_the_name_of_its_key(wrong):
    with pytest.raises(ValidationError, match=next(iter(wrong))):
        Links(imu=wrong)


def scenario(**changes: Any) -> Scenario:
    content: dict[str, Any] = {
        "name": "trial",
        "world": "flat",
        "seed": 1300,
        "duration_s": 6.0,
        "reference": {"shape": "s_curve", "parameters": {"swings": 1}},
    }
    return Scenario.model_validate(content | changes)


def driven(**links: Link) -> RunRecord:
    return drive(scenario(), "double", conditions=Conditions(plant="kinematic", links=Links(**links)))


def same(one: RunRecord, other: RunRecord) -> bool:
    channels = ("truth", "odometry", "slip", "reference", "cmd_vel")
    return all(np.array_equal(one.channel(name).values, other.channel(name).values) for name in channels)


@pytest.fixture(scope="module")
def plain():
    return driven()


def test_the_same_seed_gives_the_same_drive_bit_for_bit_over_bad_links_too(plain):
    links = {name: Link(latency_s=0.004, jitter_s=0.01, loss=0.02) for name in NAMES}
    first = driven(**links)
    assert same(first, driven(**links))
    assert not same(first, plain)


def test_commands_that_come_before_they_are_due_are_as_good_as_at_once_and_later_ones_are_not(plain):
    in_time, late = driven(command=Link(latency_s=0.03)), driven(command=Link(latency_s=0.09))
    assert same(plain, in_time)
    assert not same(plain, late)
    before, after = (run_metrics(record).values["estimated.rms_theta_rad"] for record in (plain, late))
    assert after > before


def test_a_lost_reference_leaves_the_robot_standing_and_lost_commands_are_counted_by_their_absence(plain):
    assert len(driven(reference=Link(loss=1.0)).channel("cmd_vel")) == 0
    lossy = driven(command=Link(loss=0.2))
    assert run_metrics(lossy).values["estimated.rms_distance_m"] < 0.1
    assert len(lossy.channel("cmd_vel")) == len(plain.channel("cmd_vel"))


def test_plans_without_a_way_stop_the_lower_layer():
    record = driven(plan=Link(loss=1.0))
    assert len(record.channel("upper_plan")) > 10
    assert len(record.channel("cmd_vel")) == 0


def test_belts_drive_over_links_as_well():
    links = Links(imu=Link(latency_s=0.004), estimate=Link(latency_s=0.01), plan=Link(latency_s=0.02))
    record = drive(scenario(), "double", conditions=Conditions(links=links))
    assert run_metrics(record).values["true.rms_distance_m"] < 0.1
