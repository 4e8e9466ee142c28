import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tracked_localization import OdometryFilter, OdometryFilterSettings
from tracked_types import ImuSample, PeriodGrid, Pose2, TrackSample, angle_difference

SECOND = 1_000_000_000
GRID = PeriodGrid(60)


def test_estimates_come_exactly_at_the_instants_with_the_samples_that_complete_them(
    odometry_filter, crawler, drives, feed
):
    stamps = []
    for tick in crawler(drives.curve).run(2.0):
        estimates = feed(odometry_filter, [tick])
        assert len(estimates) == (tick.tracks is not None)
        stamps += [estimate.odometry.stamp_ns for estimate in estimates]
        assert all(estimate.slip.stamp_ns == estimate.odometry.stamp_ns for estimate in estimates)
    assert stamps == [GRID.stamp_ns(index) for index in range(1, 121)]


def test_frames_are_those_of_the_robot(odometry_filter, crawler, drives, feed, robot):
    odometry = feed(odometry_filter, crawler(drives.rest).run(0.1))[-1].odometry
    assert (odometry.frame_id, odometry.child_frame_id) == (robot.frames.odom, robot.frames.base_footprint)


@pytest.mark.parametrize("seed", range(4))
def test_follows_a_slipping_robot_with_stops_and_spot_turns_and_blames_nobody(
    odometry_filter, crawler, drives, feed, seed
):
    *_, last = ticks = list(crawler(drives.wandering(seed), seed).run(12.0))
    pose = feed(odometry_filter, ticks)[-1].odometry.pose
    assert math.hypot(pose.x_m - last.pose.x_m, pose.y_m - last.pose.y_m) < 0.16
    assert abs(angle_difference(pose.yaw_rad, last.pose.yaw_rad)) < 0.08
    assert not odometry_filter.health.culprits
    assert not odometry_filter.health.counts


@pytest.mark.parametrize("seed", range(4))
def test_slip_yaw_rate_is_within_its_figure(odometry_filter, crawler, drives, feed, seed):
    ticks = list(crawler(drives.wandering(seed), seed).run(10.0))
    truth = {tick.stamp_ns: tick.slip for tick in ticks}
    slips = [estimate.slip for estimate in feed(odometry_filter, ticks)]
    errors = [slip.yaw_rate_radps - truth[slip.stamp_ns].yaw_rate_radps for slip in slips if slip.known]
    assert len(errors) > 200
    assert math.sqrt(np.mean(np.square(errors))) <= 0.03


def test_innovations_of_a_moving_robot_are_as_large_as_expected(odometry_filter, crawler, drives, feed):
    squares = {"imu": [], "tracks": []}
    for tick in crawler(drives.wandering(5), 5).run(20.0):
        feed(odometry_filter, [tick])
        for innovation in odometry_filter.drain_innovations():
            if not innovation.at_rest:
                squares[innovation.sensor].append(innovation.normalised_square)
    for values in squares.values():
        assert np.mean(values) == pytest.approx(1.0, abs=2.5 * math.sqrt(2.0 / len(values)))


def test_rest_freezes_the_pose_and_finds_the_bias_within_two_seconds(odometry_filter, crawler, drives, feed, robot):
    estimates = feed(odometry_filter, crawler(drives.rest).run(2.0))
    assert odometry_filter.standing
    assert odometry_filter.gyro_bias_radps == pytest.approx(robot.imu.gyro_bias_radps, abs=0.002)
    frozen = {estimate.odometry.pose for estimate in estimates[40:]}
    assert len(frozen) == 1
    assert not estimates[-1].slip.known


def test_health_at_a_later_time_knows_that_all_have_gone(odometry_filter, crawler, drives, feed):
    feed(odometry_filter, crawler(drives.straight).run(1.0))
    assert odometry_filter.health_at(SECOND).advancing
    later = odometry_filter.health_at(2 * SECOND)
    assert not later.advancing
    assert later.blames("imu") and later.blames("tracks")


def test_health_before_the_first_sample_advances_nothing(odometry_filter):
    assert odometry_filter.odometry is None
    assert not odometry_filter.health.advancing
    assert not odometry_filter.health.culprits


def test_order_of_arrival_does_not_change_the_estimate(settings, crawler, drives, feed):
    ticks = list(crawler(drives.wandering(2), 2).run(3.0))
    samples = [sample for tick in ticks for sample in tick.samples]
    delays = np.random.default_rng(0).uniform(0.0, 0.011, len(samples)) * SECOND
    delays[0] = 0.0
    arrived = [samples[index] for index in np.argsort([s.stamp_ns + d for s, d in zip(samples, delays, strict=True)])]
    in_order = feed(OdometryFilter(settings), samples, lambda sample: [sample])
    shuffled = feed(OdometryFilter(settings), arrived, lambda sample: [sample])
    assert len(shuffled) >= len(in_order) - 2
    for one, other in zip(in_order, shuffled, strict=False):
        assert one.odometry.pose == other.odometry.pose
        assert one.slip == other.slip


def test_samples_sent_twice_change_nothing(settings, crawler, drives, feed):
    ticks = list(crawler(drives.curve).run(2.0))
    once = feed(OdometryFilter(settings), ticks)
    repeating = OdometryFilter(settings)
    twice = feed(repeating, ticks, lambda tick: [sample for sample in tick.samples for _ in range(2)])
    assert [estimate.odometry.pose for estimate in twice] == [estimate.odometry.pose for estimate in once]
    assert repeating.health.counts["imu: duplicate"] == len(ticks)


@pytest.mark.parametrize("stamp_ns", [10**18, 0, -5])
def test_single_senseless_stamp_is_ignored(odometry_filter, crawler, drives, feed, stamp_ns):
    robot = crawler(drives.curve)
    feed(odometry_filter, robot.run(2.0))
    tick = next(robot.run(1 / 120))
    assert not odometry_filter.add_imu(replace(tick.imu, stamp_ns=stamp_ns))
    estimates = feed(odometry_filter, robot.run(1.0))
    assert estimates[-1].odometry.stamp_ns > 2.9 * SECOND
    assert odometry_filter.health.advancing


@pytest.mark.parametrize("offset_s", [-3.0, -0.5, 5.0, 1e6])
def test_clock_that_jumps_keeps_the_pose_and_goes_on(odometry_filter, crawler, drives, feed, offset_s):
    robot = crawler(drives.straight)
    before = feed(odometry_filter, robot.run(4.0))[-1].odometry
    estimates = feed(odometry_filter, robot.run(2.0, offset_s=offset_s))
    stamps = [estimate.odometry.stamp_ns for estimate in estimates]
    assert all(GRID.is_instant(stamp) for stamp in stamps)
    assert np.all(np.diff([stamp for stamp in stamps if stamp > before.stamp_ns or offset_s < 0.0][2:]) > 0)
    assert len(estimates) > 110
    pose = estimates[-1].odometry.pose
    assert pose.x_m == pytest.approx(before.pose.x_m + 0.7, abs=0.08)
    assert not odometry_filter.health.culprits
    assert odometry_filter.health.counts["clock: jumped"] == 1


def test_short_silence_of_all_is_bridged(odometry_filter, crawler, drives, feed):
    robot = crawler(drives.straight)
    feed(odometry_filter, robot.run(3.0))
    list(robot.run(0.12))
    *_, last = ticks = list(robot.run(1.0))
    pose = feed(odometry_filter, ticks)[-1].odometry.pose
    assert pose.x_m == pytest.approx(last.pose.x_m, abs=0.04)
    assert "clock: jumped" not in odometry_filter.health.counts


def test_reset_puts_the_robot_at_a_pose_and_keeps_the_bias(odometry_filter, crawler, drives, feed):
    robot = crawler(drives.rest)
    feed(odometry_filter, robot.run(2.0))
    bias = odometry_filter.gyro_bias_radps
    odometry_filter.reset(Pose2(1.0, 2.0, 0.5))
    pose = feed(odometry_filter, robot.run(0.5))[-1].odometry.pose
    assert (pose.x_m, pose.y_m, pose.yaw_rad) == pytest.approx((1.0, 2.0, 0.5), abs=0.01)
    assert odometry_filter.gyro_bias_radps == pytest.approx(bias, abs=0.001)
    odometry_filter.reset()
    assert odometry_filter.odometry.pose == Pose2(0.0, 0.0, 0.0)
    with pytest.raises(ValueError, match="finite"):
        odometry_filter.reset(Pose2(math.nan, 0.0, 0.0))


def test_reset_while_driving_goes_on_driving(odometry_filter, crawler, drives, feed):
    robot = crawler(drives.straight)
    feed(odometry_filter, robot.run(2.0))
    odometry_filter.reset()
    pose = feed(odometry_filter, robot.run(1.0))[-1].odometry.pose
    assert pose.x_m == pytest.approx(0.35, abs=0.03)
    assert not odometry_filter.health.culprits


NUMBERS = st.one_of(st.floats(allow_nan=True, allow_infinity=True), st.floats(-1.0, 1.0))
STAMPS = st.one_of(st.integers(0, 3 * SECOND), st.integers(-(2**70), 2**70), st.sampled_from([0, SECOND, 2**63]))
VECTORS = st.tuples(NUMBERS, NUMBERS, NUMBERS).map(np.array)
GARBAGE = st.one_of(
    st.builds(lambda stamp, w, a: ImuSample(stamp, "imu_link", w, a, np.eye(3), np.eye(3)), STAMPS, VECTORS, VECTORS),
    st.builds(TrackSample, STAMPS, NUMBERS, NUMBERS, NUMBERS, NUMBERS),
)


@settings(max_examples=60)
@given(garbage=st.lists(GARBAGE, max_size=80), good=st.booleans())
def test_garbage_never_breaks_the_filter(settings_of_robot, good_samples, garbage, good):
    odometry_filter = OdometryFilter(settings_of_robot)
    stream = [sample for pair in zip(garbage, good_samples, strict=False) for sample in pair] if good else garbage
    for sample in stream:
        add = odometry_filter.add_imu if isinstance(sample, ImuSample) else odometry_filter.add_tracks
        for estimate in add(sample):
            odometry = estimate.odometry
            assert np.all(np.isfinite(odometry.pose.as_array()))
            np.linalg.cholesky(odometry.pose_covariance)
            np.linalg.cholesky(odometry.twist_covariance)
            assert math.isfinite(estimate.slip.yaw_rate_radps) and math.isfinite(estimate.slip.speed_mps)
        assert odometry_filter.health.summary


@pytest.fixture(scope="module")
def settings_of_robot(robot):
    return OdometryFilterSettings.from_robot(robot)


@pytest.fixture(scope="module")
def good_samples(crawler, drives):
    return [sample for tick in crawler(drives.curve).run(1.0) for sample in tick.samples]
