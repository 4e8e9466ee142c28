import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tracked_report.channel import Channel
from tracked_report.drive_tables import coverage_warning, terminal_summary
from tracked_report.metrics import MetricSettings, NotRecordedError, compare_runs, run_metrics
from tracked_report.metrics.commands import command_metrics
from tracked_report.metrics.comparison import reduction_key, reductions
from tracked_report.metrics.slip import slip_errors
from tracked_report.metrics.timing import latencies_ms, loop
from tracked_report.metrics.tracking import tracking, tracking_metrics
from tracked_report.run_record import RunMeta, RunRecord
from tracked_report.synthetic import SyntheticSettings, synthetic_pair, synthetic_record
from tracked_types import Pose2

SETTINGS = MetricSettings()
SHORT = SyntheticSettings(duration_s=6.0)
ARC = np.linspace(0.0, 1.0, 60)
STAMPS = (1_000_000_000 + ARC * 1e9).astype(np.int64)


def poses(name, x, y, yaw):
    columns = ("x_m", "y_m", "yaw_rad")
    values = np.column_stack(np.broadcast_arrays(x, y, yaw, STAMPS))[:, :3].astype(float)
    return {name: Channel(columns, STAMPS, values, np.full(len(STAMPS), np.nan))}


def run(error, yaw=0.0, **meta):
    """Straight reference; the odometry is off by ``error``."""
    channels = poses("reference", ARC, 0.0, yaw)
    channels |= poses("odometry", ARC - error[0], -error[1], yaw - error[2])
    return RunRecord(RunMeta(scenario="test", **meta), channels)


def changed(record, **channels):
    return dataclasses.replace(record, channels={**record.channels, **channels})


def test_a_constant_error_has_its_size_as_rms_and_no_peak_to_peak():
    values = tracking_metrics(run((0.03, -0.02, 0.1)), "estimated", SETTINGS).values
    assert values["rms_x_m"] == pytest.approx(0.03)
    assert values["rms_y_m"] == pytest.approx(0.02)
    assert values["rms_theta_rad"] == pytest.approx(0.1)
    assert values["ptop_x_m"] == pytest.approx(0.0, abs=1e-12)
    assert values["final_distance_m"] == pytest.approx(math.hypot(0.03, 0.02))


@given(st.floats(-math.pi, math.pi), st.floats(-3.0, 3.0))
def test_heading_errors_do_not_see_where_angles_wrap(yaw, error):
    values = tracking_metrics(run((0.0, 0.0, error), yaw=yaw), "estimated", SETTINGS).values
    assert values["rms_theta_rad"] == pytest.approx(abs(error), abs=1e-9)
    assert values["ptop_theta_rad"] == pytest.approx(0.0, abs=1e-9)


@settings(max_examples=25, deadline=None)
@given(st.floats(-100.0, 100.0), st.floats(-100.0, 100.0), st.floats(-math.pi, math.pi))
def test_true_errors_do_not_depend_on_where_the_odom_frame_lies_in_the_world(x, y, yaw):
    at_origin = synthetic_record(SHORT)
    truth = at_origin.channel("truth").select(("x_m", "y_m", "yaw_rad"))
    frame = Pose2(x, y, yaw)
    moved = np.array([frame.compose(Pose2(*row)).as_array() for row in truth.values])
    elsewhere = changed(at_origin, truth=dataclasses.replace(truth, values=moved))
    elsewhere = dataclasses.replace(elsewhere, meta=at_origin.meta.model_copy(update={"odom_in_world": (x, y, yaw)}))
    expected = tracking_metrics(at_origin, "true", SETTINGS).values
    assert tracking_metrics(elsewhere, "true", SETTINGS).values == pytest.approx(expected, abs=1e-8)


def test_errors_long_after_the_reference_has_come_to_rest_do_not_count():
    record = synthetic_record(SHORT)
    result = tracking(record, "estimated", SETTINGS)
    assert result.stamps_ns[result.counted][-1] <= result.rest_ns + 1e9 < result.stamps_ns[-1]


def test_a_run_cut_before_the_goal_has_no_final_figures():
    record = run((0.0, 0.0, 0.0))
    cut = changed(record, odometry=record.channel("odometry").rows(np.arange(20)))
    sheet = tracking_metrics(cut, "estimated", SETTINGS)
    assert "final_distance_m" not in sheet.values
    assert "ends before" in sheet.missing["final"]


def test_a_record_that_starts_late_or_has_a_hole_says_how_much_it_covers():
    record = synthetic_record(SHORT)
    odometry = record.channel("odometry")
    holes = (odometry.rows(np.arange(60, len(odometry))), odometry.rows(np.r_[0:60, 120 : len(odometry)]))
    assert tracking_metrics(record, "estimated", SETTINGS).values["covered_percent"] == pytest.approx(100.0)
    for less in holes:
        values = compare_runs({"late": changed(record, odometry=less)}).values
        assert values["late.estimated.covered_percent"] == pytest.approx(200.0 / 3.0, abs=1.0)
        assert "estimates of late cover 6" in coverage_warning(values, ["late"])
        assert "Attention" in terminal_summary(values, ["late"], "late")


def test_a_robot_that_stays_outside_the_bounds_has_no_settling_time():
    sheet = tracking_metrics(run((0.2, 0.0, 0.0)), "estimated", SETTINGS)
    assert "did not settle" in sheet.missing["settling_s"]


def disturbed(outside_s, error=(0.0, 0.05, 0.0), disturbed_s=(1.1, 1.3)):
    """Off by ``error`` at the given times after the start, on the reference otherwise."""
    times = STAMPS / 1e9 - 1.0
    off = np.zeros(len(times))
    for begin, end in outside_s:
        off[(times >= begin) & (times < end)] = 1.0
    return run(tuple(off * size for size in error), disturbed_s=disturbed_s)


def recovery(*outside_s, hold_s=0.2, **kwargs):
    chosen = dataclasses.replace(SETTINGS, recovered_hold_s=hold_s)
    return tracking_metrics(disturbed(outside_s, **kwargs), "estimated", chosen)


def test_recovery_is_the_time_from_the_end_of_the_disturbance_until_the_errors_stay_small():
    assert recovery((0.1, 0.5)).values["recovery_s"] == pytest.approx(0.2, abs=0.02)
    assert recovery((0.1, 0.5), (0.6, 0.7)).values["recovery_s"] == pytest.approx(0.4, abs=0.02)
    assert recovery((0.1, 0.5), (0.8, 0.9)).values["recovery_s"] == pytest.approx(0.2, abs=0.02)
    assert recovery((0.1, 0.2)).values["recovery_s"] == pytest.approx(0.0, abs=0.02)
    assert recovery((0.1, 0.5), error=(0.0, 0.0, -0.06)).values["recovery_s"] == pytest.approx(0.2, abs=0.02)
    assert recovery((0.1, 0.5), error=(0.02, 0.0, 0.04)).values["recovery_s"] == pytest.approx(0.0, abs=0.02)


@pytest.mark.parametrize("outside_s", [[(0.1, 2.0)], [(0.1, 0.9)]])
def test_a_robot_that_does_not_come_back_or_not_for_long_enough_has_no_recovery_time(outside_s):
    assert "did not recover" in recovery(*outside_s).missing["recovery_s"]


def test_a_record_that_ends_before_the_disturbance_does_has_no_recovery_time_and_a_plain_run_has_no_such_figure():
    assert "did not recover" in recovery((0.1, 0.5), disturbed_s=(2.0, 3.0)).missing["recovery_s"]
    plain = recovery((0.1, 0.5), disturbed_s=None)
    assert "recovery_s" not in {**plain.values, **plain.missing}


def test_nan_rows_are_left_out_of_the_figures():
    record = synthetic_record(SHORT)
    odometry = record.channel("odometry")
    values = odometry.values.copy()
    values[::7, 0] = np.nan
    values[3] = np.inf
    sheet = run_metrics(changed(record, odometry=dataclasses.replace(odometry, values=values)))
    clean = run_metrics(record)
    assert sheet.values["estimated.rms_x_m"] == pytest.approx(clean.values["estimated.rms_x_m"], rel=0.05)
    assert all(math.isfinite(value) for value in sheet.values.values())


def test_a_column_of_nan_makes_its_group_missing():
    record = synthetic_record(SHORT)
    odometry = record.channel("odometry")
    values = np.full_like(odometry.values, np.nan)
    sheet = run_metrics(changed(record, odometry=dataclasses.replace(odometry, values=values)))
    assert "no odometry was recorded while" in sheet.missing["estimated"]
    assert "true.rms_x_m" in sheet.values


def test_an_empty_record_has_no_figures_but_reasons():
    sheet = run_metrics(RunRecord(RunMeta(scenario="empty")))
    assert sheet.values == {}
    assert set(sheet.missing) >= {"estimated", "true", "command", "slip", "ride", "solver.upper", "latency"}


def test_slip_is_compared_only_while_both_are_known():
    record = synthetic_record(SHORT)
    slip = record.channel("slip")
    values = slip.values.copy()
    values[:60, 4] = 0.0
    values[:60, :2] = 99.0
    stamps, errors = slip_errors(changed(record, slip=dataclasses.replace(slip, values=values)))
    assert np.abs(errors).max() < 1.0
    assert stamps[0] >= slip.stamps_ns[60]


def test_slip_that_is_never_known_is_missing():
    record = synthetic_record(SHORT)
    slip = record.channel("slip")
    values = slip.values.copy()
    values[:, 4] = 0.0
    with pytest.raises(NotRecordedError, match="never known"):
        slip_errors(changed(record, slip=dataclasses.replace(slip, values=values)))


def test_commands_outside_the_limits_are_counted():
    record = synthetic_record(SHORT)
    commands = record.channel("cmd_vel")
    values = np.zeros_like(commands.values)
    values[5] = (0.6, 0.0)
    values[9] = (0.0, -1.4)
    sheet = command_metrics(changed(record, cmd_vel=dataclasses.replace(commands, values=values)))
    assert sheet.values["violations"] == 2.0


def test_left_out_instants_are_counted_and_equal_stamps_are_not():
    stamps = np.array([0, 10, 20, 20, 60, 70], np.int64) * 1_000_000
    ticks = loop(Channel((), stamps, np.zeros((6, 0)), np.arange(6.0)))
    assert ticks.missed == 3
    assert ticks.wall_periods_ms.tolist() == [1000.0] * 5


def test_latency_pairs_commands_with_the_odometry_they_answer():
    record = synthetic_record(SHORT)
    assert 3.0 <= float(np.median(latencies_ms(record))) <= 8.0
    assert latencies_ms(synthetic_record(dataclasses.replace(SHORT, arrivals=False))).size == 0


def test_two_variants_give_plain_reduction_keys():
    values = compare_runs(synthetic_pair()).values
    assert values["estimated.rms_reduction_x_percent"] == pytest.approx(
        100.0 * (1.0 - values["double.estimated.rms_x_m"] / values["single.estimated.rms_x_m"])
    )
    assert values["slip.yaw_rate_rms_radps"] == max(
        values["single.slip.yaw_rate_rms_radps"], values["double.slip.yaw_rate_rms_radps"]
    )


def test_three_variants_give_reductions_behind_their_names():
    runs = {**synthetic_pair(), "third": synthetic_record(SHORT)}
    values = compare_runs(runs, baseline="double").values
    assert {"single.estimated.rms_reduction_x_percent", "third.true.ptop_reduction_theta_percent"} <= set(values)
    assert "estimated.rms_reduction_x_percent" not in values


def test_no_runs_or_an_unknown_baseline_are_refused():
    with pytest.raises(ValueError, match="no run"):
        compare_runs({})
    with pytest.raises(ValueError, match="'triple' is not among"):
        compare_runs(synthetic_pair(), baseline="triple")


def test_a_zero_baseline_has_no_reduction():
    sheet = reductions({"estimated.rms_x_m": 0.0}, {"estimated.rms_x_m": 0.1})
    assert sheet.values == {}
    assert "zero" in sheet.missing["estimated.rms_reduction_x_percent"]


@pytest.mark.parametrize(
    "key", ["solver.upper_median_ms", "rms_x_m", "estimated.final_theta_rad", "slip.rms", "true.rms"]
)
def test_figures_without_a_reduction_have_no_reduction_key(key):
    assert reduction_key(key) is None
