import numpy as np
import pytest

from tracked_localization import OdometryFilter, OdometryFilterSettings
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


@pytest.mark.parametrize("late_s", [0.08, 0.25])
def test_poses_that_come_late_say_what_they_would_have_said_in_time(settings, crawler, drives, late_s):
    ends = []
    for delay_s in (0.0, late_s):
        made = OdometryFilter(settings)
        made.expect_poses()
        run(made, crawler(drives.wandering(3), seed=3).run(12.0), late_s=delay_s, seed=1)
        ends.append(made.odometry)
    # Gains and gates of the meantime were chosen without it; that is all that is left.
    assert ends[1].pose.as_array() == pytest.approx(ends[0].pose.as_array(), abs=1e-4)
    assert ends[1].pose_covariance == pytest.approx(ends[0].pose_covariance, abs=1e-7)


def test_poses_in_any_order_of_arrival_say_almost_the_same(settings, crawler, drives):
    ticks = list(crawler(drives.wandering(3), seed=3).run(8.0))
    order = np.random.default_rng(0)
    ends = []
    for shuffled in (False, True):
        made, waiting = OdometryFilter(settings), []
        made.expect_poses()
        noise = np.random.default_rng(1)
        for tick in ticks:
            made.add_imu(tick.imu)
            if tick.tracks is not None:
                made.add_tracks(tick.tracks)
            if tick.stamp_ns % EVERY_NS == 0:
                waiting.append(measured(tick, noise))
            if len(waiting) == 4:
                for place in order.permutation(4) if shuffled else range(4):
                    made.add_pose(waiting[place])
                waiting.clear()
        assert "pose: late" not in made.health.counts
        ends.append(made.odometry)
    assert ends[1].pose.as_array() == pytest.approx(ends[0].pose.as_array(), abs=2e-3)
    in_order, shuffled = (np.trace(end.pose_covariance[:2, :2]) for end in ends)
    assert in_order <= shuffled < 1.2 * in_order


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


def test_poses_show_how_far_the_tracks_slide_outwards(settings, crawler, drives):
    crawl = crawler(drives.wandering(7), seed=7, slide_s=0.15)
    _, helped = run(OdometryFilter(settings), crawl.run(30.0), seed=3)
    assert helped[-1].slip.slide_s == pytest.approx(0.15, abs=0.05)


def test_without_poses_the_slide_is_that_of_the_settings(robot, crawler, drives):
    made = OdometryFilter(OdometryFilterSettings.from_robot(robot, slide_s=0.12))
    _, alone = run(made, crawler(drives.wandering(7), seed=7).run(3.0), change=lambda _sample: None)
    assert {estimate.slip.slide_s for estimate in alone} == {0.12}


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


def test_a_pose_ahead_of_the_sensors_waits_for_them_but_not_beyond_a_reset(settings, crawler, drives):
    ticks = list(crawler(drives.straight).run(3.0))
    made = OdometryFilter(settings)
    made.expect_poses()
    run(made, ticks[:240], change=lambda _sample: None)
    ahead = ticks[251]
    made.add_pose(PoseSample(ahead.stamp_ns, "odom", ahead.pose.compose(Pose2(0.0, 0.01, 0.0)), COVARIANCE))
    assert made.odometry.pose.y_m == pytest.approx(0.0, abs=0.005)
    made.reset()
    run(made, ticks[240:], change=lambda _sample: None)
    assert abs(made.odometry.pose.y_m) < 0.005 and "pose: jumps" not in made.health.counts


def test_more_poses_ahead_than_can_wait_are_counted(settings, crawler, drives):
    made = OdometryFilter(settings)
    run(made, crawler(drives.straight).run(1.0), change=lambda _sample: None)
    for index in range(1, 31):
        made.add_pose(PoseSample(10**9 + index * 10**7, "odom", Pose2(0.3, 0.0, 0.0), COVARIANCE))
    assert made.health.counts["pose: too many ahead of the sensors"] == 10


def test_after_a_jump_of_the_clock_poses_of_the_new_time_count_and_those_of_the_old_do_not(settings, crawler, drives):
    crawl, made = crawler(drives.straight, slide_s=0.0), OdometryFilter(settings)
    before, after = list(crawl.run(3.0)), list(crawl.run(4.0, offset_s=-2.0))
    run(made, before, seed=1)
    errors, _ = run(made, after[:60], change=lambda _sample: None)
    kept = made.odometry.pose
    made.add_pose(measured(before[-1]))
    assert made.odometry.pose == kept and made.health.blames("pose")
    errors, _ = run(made, after[60:], seed=2)
    assert np.abs(errors[-60:]).max() < 0.03


def test_without_patience_for_poses_none_is_fused(robot, crawler, drives):
    made = OdometryFilter(OdometryFilterSettings.from_robot(robot, pose_patience_s=0.0))
    plain = OdometryFilter(OdometryFilterSettings.from_robot(robot))
    run(made, crawler(drives.curve).run(3.0), late_s=0.0, seed=1)
    run(plain, crawler(drives.curve).run(3.0), change=lambda _sample: None)
    assert made.odometry.pose == plain.odometry.pose and made.health.counts["pose: late"] > 20


def test_the_covariance_of_the_twist_is_that_of_the_speed_over_ground(settings, crawler, drives):
    _, alone = run(OdometryFilter(settings), crawler(drives.straight).run(6.0), change=lambda _sample: None)
    _, helped = run(OdometryFilter(settings), crawler(drives.straight).run(6.0), seed=1)
    # The share that the ground takes is uncertain, and poses make that known.
    assert helped[-1].odometry.twist_covariance[0, 0] > alone[-1].odometry.twist_covariance[0, 0]
    assert np.linalg.eigvalsh(helped[-1].odometry.twist_covariance).min() > 0.0
