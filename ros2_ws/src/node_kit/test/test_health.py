"""Diagnostics, rejection counts, callback failures and refusals, without ROS."""

from dataclasses import dataclass, field
from functools import partial

import pytest

from node_kit import Level, RejectedMessage
from node_kit.diagnostics import DiagnosticBook
from node_kit.failures import CallbackFailures, callback_name, is_milestone
from node_kit.input_monitor import InputMonitor
from node_kit.rejection import MOST_REASONS, RejectionLedger
from node_kit.services import answering


def test_first_report_and_every_change_of_level_are_urgent():
    book = DiagnosticBook()
    assert book.report("filter", Level.OK, "fine", {}, 0.0)
    assert book.report("filter", Level.OK, "fine", {}, 0.01) is None
    assert book.report("filter", Level.ERROR, "diverged", {}, 0.02)
    assert book.report("filter", Level.OK, "fine", {}, 0.03)


def test_message_that_changes_all_the_time_is_urgent_ten_times_a_second():
    book = DiagnosticBook()
    urgent = sum(
        book.report("filter", Level.OK, f"error {index}", {}, index / 100.0) is not None for index in range(101)
    )
    assert 9 <= urgent <= 11


def test_book_keeps_the_newest_values_as_text():
    book = DiagnosticBook()
    book.report("filter", Level.OK, "fine", {"nis": 0.123456789, "count": 3}, 0.0)
    book.report("filter", Level.OK, "fine", {"nis": 1.0, "count": 4}, 0.01)
    assert [report.values for report in book.all()] == [{"nis": "1", "count": "4"}]


def test_rejections_are_counted_by_reason_and_sender():
    ledger = RejectionLedger("scan", accepted=7)
    assert [ledger.reject("not finite: x", "/a"), ledger.reject("not finite: x", "/a")] == [1, 2]
    ledger.reject("not finite: x", "/b")
    assert ledger.rejected.total() == 3
    assert ledger.as_values() == {
        "scan: accepted": "7",
        "scan: not finite: x (from /a)": "2",
        "scan: not finite: x (from /b)": "1",
    }


def test_hostile_variety_of_reasons_does_not_fill_the_memory():
    ledger = RejectionLedger("scan")
    for index in range(10 * MOST_REASONS):
        ledger.reject(f"size is {index}", "/a")
    assert len(ledger.rejected) == MOST_REASONS + 1
    assert ledger.rejected.total() == 10 * MOST_REASONS


def test_inputs_warn_while_rejections_are_fresh():
    monitor = InputMonitor(memory_s=5.0)
    scan, imu = monitor.add("scan"), monitor.add("imu")
    assert monitor.summary(0.0)[0] == Level.OK
    scan.reject("not finite: angle_min", "/lidar")
    assert monitor.note_rejection("scan", 10.0)
    assert not monitor.note_rejection("scan", 11.0)
    imu.accepted += 1
    level, message, values = monitor.summary(12.0)
    assert (level, message) == (Level.WARN, "rejected: scan (not finite: angle_min, from /lidar)")
    assert values["imu: accepted"] == "1"
    assert monitor.summary(16.5)[0] == Level.OK


@pytest.mark.parametrize(("count", "worth"), [(1, True), (2, False), (10, True), (20, False), (100, True)])
def test_log_follows_powers_of_ten(count, worth):
    assert is_milestone(count) is worth


def test_failing_callback_is_named_counted_and_served_on():
    lines, seen = [], []
    failures = CallbackFailures(lines.append, seen.append)

    def on_scan(value: int) -> None:
        if value < 0:
            raise ValueError(f"cannot use {value}")
        seen.append(value)

    guarded = failures.guarded(on_scan)
    for value in (-1, 1, -2):
        guarded(value)
    name = callback_name(on_scan)
    assert seen == [f"{name} failed: ValueError: cannot use -1", 1, f"{name} failed: ValueError: cannot use -2"]
    assert failures.counts[f"{name}: ValueError"] == 2
    assert len(lines) == 1
    assert "Traceback" in lines[0]


def test_callbacks_of_every_kind_have_a_name():
    assert callback_name(partial(answering, 1)) == "answering"
    assert callback_name(RejectionLedger("x").reject) == "RejectionLedger.reject"


@dataclass
class Result:
    result: int = 0
    error_message: str = ""


@dataclass
class TriggerResponse:
    success: bool = True
    message: str = ""


@dataclass
class SimulatorResponse:
    result: Result = field(default_factory=Result)


def failing(error):
    def handler(request, response):
        raise error

    return handler


def test_rejected_request_is_answered_with_the_reason():
    failures = CallbackFailures(pytest.fail, pytest.fail)
    answer = answering(failing(RejectedMessage("not finite: pose.x")), failures)(None, TriggerResponse())
    assert (answer.success, answer.message) == (False, "not finite: pose.x")


def test_request_that_fails_is_answered_and_noted():
    lines = []
    failures = CallbackFailures(lines.append, lines.append)
    answer = answering(failing(KeyError("wheel")), failures)(None, SimulatorResponse())
    assert (answer.result.result, answer.result.error_message) == (4, "KeyError: 'wheel'")
    assert len(lines) == 2
