import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tracked_localization import OdometryFilter
from tracked_localization.pose_memory import PoseMemory
from tracked_localization.state import SIZE
from tracked_types import ImuSample, Pose2, PoseSample, angle_difference

DEVIATIONS = np.array([0.01, 0.01, 0.006])
COVARIANCE = np.diag(DEVIATIONS**2)
EVERY_NS = 10**8


def measured(tick, generator=None, frame_id="odom"):
    noise = DEVIATIONS * generator.standard_normal(3) if generator is not None else np.zeros(3)
    return PoseSample(tick.stamp_ns, frame_id, Pose2(*(tick.pose.as_array() + noise).tolist()), COVARIANCE)


def run(odometry_filter, ticks, *, late_s=0.08, seed=None, change=lambda sample: sample):
    """Feed sensors, and ten poses a second that come late; errors (n, 3) at the IMU's stamps, and estimates."""
    generator = None if seed is None else np.random.default_rng(seed)
    under_way, estimates, truth = [], [], {}
    for tick in ticks:
        truth[tick.stamp_ns] = tick.pose
        if tick.stamp_ns % EVERY_NS == 0:
            under_way.append((tick.stamp_ns + round(late_s * 1e9), change(measured(tick, generator))))
        for sample in [tick.imu] if tick.tracks is None else [tick.imu, tick.tracks]:
            add = odometry_filter.add_imu if isinstance(sample, ImuSample) else odometry_filter.add_tracks
            estimates += add(sample)
        while under_way and tick.stamp_ns >= under_way[0][0]:
            pose = under_way.pop(0)[1]
            estimates += [] if pose is None else odometry_filter.add_pose(pose)
    for _, pose in under_way:
        estimates += [] if pose is None else odometry_filter.add_pose(pose)
    errors = [
        [
            estimate.odometry.pose.x_m - truth[estimate.odometry.stamp_ns].x_m,
            estimate.odometry.pose.y_m - truth[estimate.odometry.stamp_ns].y_m,
            angle_difference(estimate.odometry.pose.yaw_rad, truth[estimate.odometry.stamp_ns].yaw_rad),
        ]
        for estimate in estimates
    ]
    return np.array(errors), estimates


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6), late=st.integers(1, 8))
def test_on_a_linear_filter_a_late_measurement_counts_as_one_in_time_with_the_same_gains(seed, late):
    generator = np.random.default_rng(seed)
    changes = [np.eye(SIZE) + 0.05 * generator.standard_normal((SIZE, SIZE)) for _ in range(8)]
    rows = [generator.standard_normal((1, SIZE)) for _ in range(8)]
    gains = [0.1 * generator.standard_normal((SIZE, 1)) for _ in range(8)]
    values = 0.1 * generator.standard_normal(8)

    def simulate(applied_at):
        state, covariance, memory = np.zeros(SIZE), np.eye(SIZE), PoseMemory(10**9)
        memory.begin()
        for step in range(9):
            memory.mark(step, state, covariance)
            if step == 0:
                snapshot, variance = memory.nearest(0), covariance[:3, :3] + np.eye(3)
                gain = np.linalg.solve(variance, covariance[:3]).T
                change, spread = gain @ [0.3, -0.2, 0.1], -gain @ variance @ gain.T
            if step == applied_at:
                memory.apply(snapshot, change, spread, state, covariance)
            if step == 8:
                break
            keep = np.eye(SIZE) - gains[step] @ rows[step]
            state = keep @ changes[step] @ state + gains[step][:, 0] * values[step]
            covariance = keep @ changes[step] @ covariance @ changes[step].T @ keep.T + gains[step] @ gains[step].T
            memory.carry(changes[step])
            memory.correct(gains[step], rows[step])
        return state, covariance

    in_time, afterwards = simulate(0), simulate(late)
    assert afterwards[0] == pytest.approx(in_time[0], abs=1e-9)
    assert afterwards[1] == pytest.approx(in_time[1], abs=1e-9)


def test_poses_that_come_late_say_almost_what_they_would_have_said_in_time(settings, crawler, drives):
    ends = []
    for late_s in (0.0, 0.08, 0.25):
        made = OdometryFilter(settings)
        run(made, crawler(drives.wandering(3), seed=3).run(12.0), late_s=late_s, seed=1)
        ends.append(made.odometry)
    for other in ends[1:]:
        assert np.hypot(other.pose.x_m - ends[0].pose.x_m, other.pose.y_m - ends[0].pose.y_m) < 0.012
        assert abs(angle_difference(other.pose.yaw_rad, ends[0].pose.yaw_rad)) < 0.002


def test_poses_hold_a_drift_that_odometry_cannot_see(settings, crawler, drives):
    drive = drives.wandering(5)
    alone, _ = run(OdometryFilter(settings), crawler(drive, seed=5).run(40.0), change=lambda _sample: None)
    helped, _ = run(OdometryFilter(settings), crawler(drive, seed=5).run(40.0), seed=2)
    assert np.abs(alone[:, :2]).max() > 0.04
    assert np.sqrt((helped[240:] ** 2).mean(axis=0))[:2].max() < 0.015


def test_poses_show_how_much_of_the_speed_the_ground_takes(settings, crawler, drives):
    def with_longer_belts(sample):
        return PoseSample(sample.stamp_ns, "odom", Pose2(0.9 * sample.pose.x_m, 0.0, 0.0), COVARIANCE)

    _, estimates = run(
        OdometryFilter(settings), crawler(drives.straight, slide_s=0.0).run(8.0), seed=1, change=with_longer_belts
    )
    last = estimates[-1]
    assert last.odometry.twist.speed_mps == pytest.approx(0.35 * 0.99 * 0.9, abs=0.01)
    assert last.slip.speed_mps == pytest.approx(-0.35 * (1.0 - 0.99 * 0.9), abs=0.01)


def test_the_covariance_with_late_poses_tells_how_wrong_the_pose_is(settings, crawler, drives):
    squares = []
    for seed in range(12):
        crawl = crawler(drives.wandering(100 + seed), seed=100 + seed, slide_s=0.1)
        errors, estimates = run(OdometryFilter(settings), crawl.run(15.0), seed=seed)
        for index in range(300, len(errors), 60):
            covariance = estimates[index].odometry.pose_covariance
            squares.append(errors[index] @ np.linalg.solve(covariance, errors[index]))
    assert 0.8 < np.mean(squares) < 4.5  # three degrees of freedom


def test_between_the_instants_of_the_odometry_a_pose_is_taken_where_it_was_measured(settings, crawler, drives):
    made, errors = OdometryFilter(settings), []
    for tick in crawler(drives.straight, slide_s=0.0).run(6.0):
        for sample in [tick.imu] if tick.tracks is None else [tick.imu, tick.tracks]:
            add = made.add_imu if isinstance(sample, ImuSample) else made.add_tracks
            for estimate in add(sample):
                errors.append(estimate.odometry.pose.x_m - tick.pose.x_m)
        if tick.stamp_ns % EVERY_NS > 5 * 10**6 and tick.tracks is None:
            made.add_pose(measured(tick))
    assert np.abs(errors[120:]).max() < 0.006


@pytest.mark.parametrize(
    ("spoil", "what"),
    [
        (lambda s: PoseSample(s.stamp_ns, "odom", Pose2(np.nan, 0.0, 0.0), COVARIANCE), "not a finite number"),
        (lambda s: PoseSample(s.stamp_ns, "odom", s.pose, np.diag([1.0, -1.0, 1.0])), "covariance is none"),
        (lambda s: PoseSample(s.stamp_ns, "odom", s.pose, np.full((3, 3), np.inf)), "covariance is none"),
        (lambda s: PoseSample(s.stamp_ns, "odom", s.pose, np.eye(2)), "covariance is none"),
        (lambda s: PoseSample(s.stamp_ns, "map", s.pose, COVARIANCE), "in another frame"),
        (lambda s: PoseSample(s.stamp_ns + 10**9, "odom", s.pose, COVARIANCE), "stamps are wrong"),
        (lambda s: PoseSample(s.stamp_ns - 2 * 10**9, "odom", s.pose, COVARIANCE), "late"),
    ],
)
def test_a_pose_that_means_nothing_is_refused_by_name_and_moves_nothing(settings, crawler, drives, spoil, what):
    plain, _ = run(OdometryFilter(settings), crawler(drives.curve).run(4.0), change=lambda _sample: None)
    made = OdometryFilter(settings)
    spoiled, _ = run(made, crawler(drives.curve).run(4.0), late_s=0.0, change=spoil)
    assert made.health.counts[f"pose: {what}"] > 10
    assert spoiled == pytest.approx(plain, abs=1e-6)


def test_a_pose_that_is_sent_twice_counts_once(settings, crawler, drives):
    once, twice = OdometryFilter(settings), OdometryFilter(settings)
    for made, times in ((once, 1), (twice, 2)):
        for tick in crawler(drives.straight).run(2.0):
            made.add_imu(tick.imu)
            if tick.tracks is not None:
                made.add_tracks(tick.tracks)
            if tick.stamp_ns % EVERY_NS == 0:
                for _ in range(times):
                    made.add_pose(measured(tick))
    assert twice.odometry.pose == once.odometry.pose
    assert twice.health.counts["pose: duplicate"] > 10


def test_one_pose_that_jumps_is_blamed_and_ignored(settings, crawler, drives):
    def jump(sample):
        if sample.stamp_ns != 30 * EVERY_NS:
            return sample
        return PoseSample(sample.stamp_ns, "odom", sample.pose.compose(Pose2(0.5, 0.0, 0.0)), COVARIANCE)

    made = OdometryFilter(settings)
    errors, _ = run(made, crawler(drives.straight, slide_s=0.0).run(4.0), seed=1, change=jump)
    assert made.health.counts["pose: jumps"] == 1 and np.abs(errors[120:]).max() < 0.04


def test_a_robot_that_was_carried_away_believes_its_poses_after_a_second(settings, crawler, drives):
    def carried(sample):
        if sample.stamp_ns < 30 * EVERY_NS:
            return sample
        return PoseSample(sample.stamp_ns, "odom", Pose2(5.0, 1.0, 0.5).compose(sample.pose), COVARIANCE)

    made = OdometryFilter(settings)
    ticks = list(crawler(drives.straight, slide_s=0.0).run(6.0))
    run(made, ticks, seed=1, change=carried)
    wanted = Pose2(5.0, 1.0, 0.5).compose(ticks[-1].pose)
    found = made.odometry.pose
    assert made.health.counts["pose: followed after all"] == 1
    assert np.hypot(found.x_m - wanted.x_m, found.y_m - wanted.y_m) < 0.05


def test_a_reset_forgets_the_poses_that_are_still_to_come(settings, crawler, drives):
    made = OdometryFilter(settings)
    ticks = list(crawler(drives.straight).run(3.0))
    run(made, ticks, seed=1)
    made.reset()
    made.add_pose(measured(ticks[-20]))
    assert made.odometry.pose == Pose2(0.0, 0.0, 0.0)
