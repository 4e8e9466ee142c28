"""The lidar's pose: where, when, how late and how noisy."""

from typing import Any

import numpy as np
import pytest

from tracked_description import load_robot
from tracked_lab import Conditions, drive
from tracked_lab.closed_loop import ClosedLoop
from tracked_lab.conditions import Link, Links
from tracked_lab.kinematic_plant import KinematicPlant
from tracked_lab.lidar_pose import LidarPose
from tracked_lab.links import LinkScheduler
from tracked_lab.stack import Stack
from tracked_report.metrics import run_metrics
from tracked_report.scenario import Scenario
from tracked_types import BodyState, PeriodGrid, Pose2, angle_difference

ROBOT = load_robot()
START = Pose2(1.0, -2.0, 2.5)


def state(stamp_ns: int, pose: Pose2) -> BodyState:
    zeros = np.zeros(3)
    return BodyState(stamp_ns, np.array([pose.x_m, pose.y_m, 0.0]), np.array([0, 0, pose.yaw_rad]), zeros, zeros, 0.0)


def samples(seed: int, true: Pose2, seconds: int = 100):
    lidar, grid = LidarPose(ROBOT, seed, START), PeriodGrid(ROBOT.odometry.rate_hz)
    made = (lidar.update(state(grid.stamp_ns(index), true)) for index in range(1, seconds * grid.rate_hz + 1))
    return [sample for sample in made if sample is not None]


def test_ten_a_second_in_the_frame_of_the_odometry_with_the_noise_that_their_covariance_says():
    local = Pose2(0.5, 0.3, 0.9)  # beyond the wrap in the world
    found = samples(1, START.compose(local))
    assert len(found) == 1000
    assert {sample.frame_id for sample in found} == {ROBOT.frames.odom}
    errors = np.array([sample.pose.as_array() - local.as_array() for sample in found])
    errors[:, 2] = [angle_difference(sample.pose.yaw_rad, local.yaw_rad) for sample in found]
    deviations = np.sqrt(found[0].covariance.diagonal())
    assert deviations == pytest.approx([0.01, 0.01, 0.006])
    assert errors.std(axis=0) == pytest.approx(deviations, rel=0.1)
    assert np.all(np.abs(errors.mean(axis=0)) < 4.0 * deviations / np.sqrt(len(errors)))


def test_the_seed_says_the_noise():
    first, again, other = (samples(seed, START, 1) for seed in (1, 1, 2))
    assert [sample.pose for sample in first] == [sample.pose for sample in again]
    assert all(one.pose != another.pose for one, another in zip(first, other, strict=True))


@pytest.mark.parametrize(("link", "late_s"), [(Link(), 0.08), (Link(latency_s=0.05), 0.13)])
def test_the_filter_hears_of_it_eighty_milliseconds_late_and_later_over_a_slow_link(link, late_s):
    stack, plant = Stack(ROBOT, {}), KinematicPlant(ROBOT, 1)
    links, heard = LinkScheduler(Links(pose=link), 1), []
    loop = ClosedLoop(plant, stack, links, lidar_pose=LidarPose(ROBOT, 1, plant.start))
    loop._hear_pose = lambda sample: heard.append((links.now_ns - sample.stamp_ns) / 1e9)  # type: ignore[method-assign]
    for _ in range(ROBOT.imu.rate_hz):
        loop.tick()
    assert len(heard) in (8, 9)
    assert heard == pytest.approx([late_s] * len(heard))


def test_the_slide_that_poses_show_is_learnt_and_takes_the_robot_closer_to_its_path() -> None:
    content: dict[str, Any] = {
        "name": "slide",
        "world": "flat",
        "seed": 1001,
        "duration_s": 10.0,
        "pipeline_latency_s": 0.1,
        "reference": {"shape": "s_curve"},
        "variants": {
            "learning": {},
            "not_learning": {"parameters": {"ekf": {"slide_deviation_s": 0.0, "slide_walk_sqrt_s": 0.0}}},
        },
    }
    conditions = Conditions(plant="kinematic", pose="lidar", slip_severity=2.0)
    error = {}
    for variant in content["variants"]:
        record = drive(Scenario.model_validate(content), variant, conditions=conditions)
        error[variant] = run_metrics(record).values["true.rms_y_m"]
    assert error["learning"] < 0.8 * error["not_learning"]
