"""Whole drives to goals in the simulated rooms, without ROS."""

import numpy as np
import pytest

from sim_bridge.world import load_world
from tracked_description import Footprint, load_robot
from tracked_lab.goal_drive import GoalDrive
from tracked_lab.true_map import true_map
from tracked_navigation.navigator import Outcome
from tracked_types import OCCUPIED, UNKNOWN, Pose2, angle_difference

ROBOT = load_robot()
LIDAR_HEIGHT_M = ROBOT.base_link_height_m + ROBOT.lidar.xyz_m[2]


def test_robot_drives_through_a_door_to_where_it_was_sent_and_touches_nothing():
    world, goal = load_world("rooms"), Pose2(2.0, 4.5, 1.57)
    occupancy_map = true_map(world, lidar_height_m=LIDAR_HEIGHT_M)
    walls = occupancy_map.centres_of(np.argwhere(occupancy_map.occupied))
    footprint = Footprint.from_robot(ROBOT)
    drive = GoalDrive(ROBOT, world, occupancy_map, seed=3, start=world.start())
    room_m, finished, truth = np.inf, None, None
    try:
        for moment in drive.drive([goal], limit_s=40.0):
            truth, finished = moment.truth or truth, moment.finished
            if moment.truth is not None:
                near = moment.truth.pose.inverse().transform(walls)
                room_m = min(room_m, float(footprint.distance(near).min()))
    finally:
        drive.close()
    assert finished is not None and finished.outcome is Outcome.SUCCEEDED
    assert np.hypot(truth.pose.x_m - goal.x_m, truth.pose.y_m - goal.y_m) <= 0.05
    assert abs(angle_difference(truth.pose.yaw_rad, goal.yaw_rad)) <= 0.05
    assert room_m > 0.02


def test_map_of_a_world_shows_faces_that_the_lidar_meets_and_no_more():
    occupancy_map = true_map(load_world("rooms_busy"), lidar_height_m=LIDAR_HEIGHT_M, without=frozenset({"box"}))

    def at(x, y):
        (row,), (column,), _ = occupancy_map.look_up(np.array([[x, y]]))
        return occupancy_map.occupancy[row, column]

    assert at(4.0, 3.0 - 0.05) == OCCUPIED  # a wall
    assert at(2.0, 3.0) == 0  # the door that the box blocks
    assert at(2.7, 1.5) == 0  # the sill is lower than the lidar
    assert at(-0.4, 3.0) == UNKNOWN  # beyond the walls
    with pytest.raises(ValueError, match="nothing reaches up to the lidar"):
        true_map(load_world("flat"), lidar_height_m=LIDAR_HEIGHT_M)
