import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tracked_lab.recordings import (
    TARGETS,
    DriveWindows,
    OutdoorDrive,
    RecordingError,
    compare,
    compare_with_gps,
    load_drive_windows,
    load_outdoor_drive,
    load_vehicle,
    run_filter,
    wheels_alone,
    wheels_and_gyro,
)
from tracked_lab.recordings.drive_windows import PERIOD_S
from tracked_lab.recordings.outdoor_drive import seconds_of, wheel_travel
from tracked_lab.recordings.slip_comparison import cross_fitted
from tracked_lab.recordings.vehicle import Vehicle
from tracked_types.checked_yaml import CheckedFileError


@pytest.fixture(scope="module")
def slipping():
    return load_vehicle("norlab_husky")


@pytest.fixture(scope="module")
def outdoors():
    return load_vehicle("husky_outdoor").filter_settings()


@pytest.fixture(scope="module")
def drive(outdoors):
    return load_outdoor_drive(outdoors.gauge_m, outdoors.encoder_tick_m)


@pytest.fixture(scope="module")
def run(drive, outdoors):
    return run_filter(drive, outdoors)


def rms(methods):
    return {method.key: method.rms_m for method in methods}


def test_slip_law_halves_the_error_of_a_real_vehicle(slipping):
    windows = load_drive_windows(slipping.as_robot().tracks.wheel_radius_m)
    errors = rms(compare(windows, slipping.slip_settings()))
    assert len(windows) + windows.left_out == 603
    assert errors["slip_law"] <= TARGETS["recordings.slip.slip_law.rms_m"].limit
    assert errors["slip_law_fitted"] <= TARGETS["recordings.slip.slip_law_fitted.rms_m"].limit
    assert errors["slip_law"] < 0.5 * errors["nominal"] and errors["slip_law"] < 0.7 * errors["yaw_rate"]


def windows_of(left_mps, right_mps, forward_mps, turn_radps):
    """Windows whose bodies move like this, constant within each: all (n,)."""
    ones = np.ones(40)
    yaw = np.outer(turn_radps, PERIOD_S * np.arange(40))
    middle = 0.5 * (yaw[:, 1:] + yaw[:, :-1])
    steps = PERIOD_S * np.asarray(forward_mps)[:, None]
    x, y = (np.cumsum(steps * part(middle), axis=1) for part in (np.cos, np.sin))
    zero = np.zeros((len(yaw), 1))
    return DriveWindows(
        np.outer(left_mps, ones), np.outer(right_mps, ones), np.hstack([zero, x]), np.hstack([zero, y]), yaw
    )


def test_a_vehicle_that_does_not_slip_is_reckoned_exactly_by_every_method(slipping):
    random = np.random.default_rng(3)
    gauge_m, (left, right) = slipping.slip_settings().gauge_m, random.uniform(-1.0, 1.0, (2, 25))
    methods = compare(windows_of(left, right, 0.5 * (left + right), (right - left) / gauge_m), slipping.slip_settings())
    assert max(rms(methods).values()) < 1e-9


def test_a_vehicle_that_slips_as_the_law_says_is_reckoned_exactly_by_it(slipping):
    random = np.random.default_rng(4)
    gauge_m, (left, right) = slipping.slip_settings().gauge_m, random.uniform(0.1, 1.0, (2, 25))
    share = random.uniform(0.3, 0.9, 25)  # of the wheels' yaw rate; the ratios of the sides are opposite and equal
    turn = share * (right - left) / gauge_m
    ratio = gauge_m * (turn - (right - left) / gauge_m) / (left + right)
    forward = 0.5 * (left * (1.0 - ratio) + right * (1.0 + ratio))
    errors = rms(compare(windows_of(left, right, forward, turn), slipping.slip_settings()))
    assert errors["slip_law"] < 1e-9 < 0.01 < errors["yaw_rate"]


def test_no_window_is_predicted_by_a_fit_that_has_seen_it():
    feature, target = np.ones((10, 3)), np.ones((10, 3))
    target[:2] = 5.0  # the first of five folds; the others say one
    assert np.allclose(cross_fitted([feature], target)[:2], 1.0)


def test_broken_windows_are_left_out(tmp_path, slipping):
    with np.load(_packaged("norlab_drive_husky")) as content:
        fields = {name: np.array(content[name][:20]) for name in content.files}
    fields["icp_y"][3, 10] += 1.0
    fields["left_wheel_vel"][4, 0] = math.nan
    before = load_drive_windows(0.165, _saved(tmp_path / "few.npz", **fields))
    fields["icp_x"][5, 20:] -= 2.0
    assert len(load_drive_windows(0.165, _saved(tmp_path / "fewer.npz", **fields))) == len(before) - 1


def _packaged(name):
    from importlib import resources

    return resources.files("tracked_lab") / "data" / "recordings" / f"{name}.npz"


def _saved(path, **fields):
    np.savez(path, **fields)
    return path


def test_files_that_are_no_recordings_are_named(tmp_path):
    (tmp_path / "text.npz").write_text("no array")
    for path, said in (
        (tmp_path / "none.npz", "cannot be read"),
        (tmp_path / "text.npz", "is no recording"),
        (_saved(tmp_path / "other.npz", imu_t=np.zeros(3)), "has no"),
    ):
        with pytest.raises(RecordingError, match=f"{path.name}: {said}"):
            load_drive_windows(0.165, path)
    with np.load(_packaged("husky_outdoor_imu_odom_gps")) as content:
        fields = {name: np.array(content[name]) for name in content.files}
    fields["imu_t"][7] = fields["imu_t"][3]
    with pytest.raises(RecordingError, match="imu_t does not increase"):
        load_outdoor_drive(1.0, 0.001, _saved(tmp_path / "back.npz", **fields))


def test_a_vehicle_with_an_unknown_key_is_refused():
    with pytest.raises(CheckedFileError, match=r"recorded vehicle: tracks\.gauge"):
        Vehicle(source="nowhere", robot={"tracks": {"gauge": 1.0}}).as_robot()
    with pytest.raises(CheckedFileError, match=r"mars_rover\.yaml"):
        load_vehicle("mars_rover")


def test_whole_filter_on_a_real_drive_beats_dead_reckoning_and_refuses_nothing(drive, run, outdoors):
    def distance(times_s, positions_m):
        return compare_with_gps(times_s, positions_m, drive.gps_s, drive.gps_m).mean_m

    filtered = distance(run.times_s, run.positions_m)
    assert filtered <= TARGETS["recordings.outdoor.filter.mean_m"].limit
    assert filtered < distance(drive.wheels_s, wheels_and_gyro(drive))
    assert filtered < 0.6 * distance(drive.wheels_s, wheels_alone(drive, outdoors.gauge_m))
    assert not run.offences
    assert max(run.longest_deaf_s.values()) <= TARGETS["recordings.outdoor.longest_deaf_s"].limit


def test_real_rest_teaches_the_bias_of_the_gyro_and_does_not_move_the_pose(drive, run):
    begin_s, end_s = max(run.rests_s, key=lambda rest: rest[1] - rest[0])
    assert end_s - begin_s > 5.0
    resting = (drive.imu_s > begin_s + 1.0) & (drive.imu_s < end_s - 1.0)
    assert run.bias_at(end_s - 1.0) == pytest.approx(drive.gyro_radps[resting, 2].mean(), abs=3e-4)
    during = (run.times_s > begin_s - 0.3) & (run.times_s < end_s - 1.0)
    assert np.ptp(run.positions_m[during], axis=0).max() < 0.01


def test_a_gyro_that_is_out_of_its_mind_is_refused_and_seen_to_be(drive, outdoors):
    few = slice(0, 1200)
    gyro = np.array(drive.gyro_radps[few])
    gyro[600:800, 2] = 4.0
    wheels = drive.wheels_s < drive.imu_s[1199]
    broken = OutdoorDrive(
        drive.imu_s[few],
        gyro,
        drive.acceleration_mps2[few],
        drive.wheels_s[wheels],
        drive.left_m[wheels],
        drive.right_m[wheels],
        drive.gps_s,
        drive.gps_m,
    )
    seen = run_filter(broken, outdoors)
    assert seen.longest_deaf_s["imu"] > 6.0
    assert seen.offences["imu: jumps"] > 0


def test_samples_come_in_the_order_of_their_stamps(drive):
    stamps = [sample.stamp_ns for sample in drive.samples()]
    assert stamps == sorted(stamps)
    assert len(stamps) == len(drive.imu_s) + len(drive.wheels_s)
    assert seconds_of(stamps[0]) == pytest.approx(0.0, abs=1e-9)


@settings(max_examples=40)
@given(
    counts=st.lists(st.tuples(st.integers(-150, 150), st.integers(-150, 150)), min_size=1, max_size=50),
    yaw=st.floats(-3.0, 3.0),
)
def test_wheel_counts_come_back_out_of_the_pose_that_was_integrated_from_them(counts, yaw):
    gauge_m, tick_m, poses = 1.07, 0.001, [(0.3, -0.2, yaw)]
    for left, right in counts:
        x, y, heading = poses[-1]
        turn, arc = tick_m * (right - left) / gauge_m, 0.5 * tick_m * (left + right)
        chord = arc * np.sinc(0.5 * turn / np.pi)
        middle = heading + 0.5 * turn
        poses.append((x + chord * math.cos(middle), y + chord * math.sin(middle), heading + turn))
    wrapped = np.array(poses)
    wrapped[:, 2] = np.arctan2(np.sin(wrapped[:, 2]), np.cos(wrapped[:, 2]))
    left, right = wheel_travel(wrapped, gauge_m, tick_m)
    assert np.allclose(np.diff(left), [tick_m * count for count, _ in counts], atol=1e-9)
    assert np.allclose(np.diff(right), [tick_m * count for _, count in counts], atol=1e-9)


@settings(max_examples=40)
@given(angle=st.floats(-3.1, 3.1), east=st.floats(-1e3, 1e3), north=st.floats(-1e3, 1e3))
def test_alignment_undoes_any_turn_and_shift(angle, east, north):
    times = np.linspace(0.0, 100.0, 51)
    gps = np.stack([times, 10.0 * np.sin(0.1 * times)], axis=1)
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    assert compare_with_gps(times, gps @ turn.T + [east, north], times, gps).largest_m < 1e-6


def test_alignment_without_early_fixes_is_refused():
    with pytest.raises(ValueError, match="fewer than two fixes"):
        compare_with_gps(np.arange(3.0), np.zeros((3, 2)), np.array([70.0, 80.0]), np.zeros((2, 2)))
