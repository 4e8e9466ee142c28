"""The nodes that offer maps: latched for late comers, saved and loaded, and clear about what they cannot do."""

import math
import signal
from array import array

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetMap, LoadMap
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage

from node_kit import qos
from node_kit.conversions import occupancy_grid_from_message
from tests.support.room_robot import RoomRobot, room_map_file
from tracked_localization.mapping.map_files import load_map
from tracked_localization.matching.line_world import ROOM
from tracked_types import Pose2

START_LIMIT_S = 60.0
KEEP = QoSProfile(depth=2000, reliability=ReliabilityPolicy.RELIABLE)


def test_a_map_server_keeps_its_map_for_late_comers_and_replaces_it_only_by_one_that_can_be_used(
    probe, start_node, tmp_path
):
    file = room_map_file(tmp_path)
    start_node("tracked_localization", "map_server", "--ros-args", "-p", f"map:={file}")
    answer = probe.call(GetMap, "get_map", timeout_s=START_LIMIT_S)
    expected = load_map(file, "map")
    assert np.array_equal(occupancy_grid_from_message(answer.map).occupancy, expected.occupancy)
    late = probe.collect(OccupancyGrid, "map", qos.LATCHED)
    probe.wait_until(lambda: late, what="the map, long after it was published")
    got = occupancy_grid_from_message(late[0])
    assert got.frame_id == "map" and got.origin.x_m == pytest.approx(expected.origin.x_m)

    broken = tmp_path / "broken.yaml"
    broken.write_text(file.read_text().replace("resolution: 0.05", "resolution: -0.05"))
    imageless = tmp_path / "imageless.yaml"
    imageless.write_text(file.read_text().replace("room.pgm", "gone.pgm"))
    codes = LoadMap.Response
    for url, code in (
        (str(tmp_path / "nowhere.yaml"), codes.RESULT_MAP_DOES_NOT_EXIST),
        (str(broken), codes.RESULT_INVALID_MAP_METADATA),
        (str(imageless), codes.RESULT_INVALID_MAP_DATA),
        ("", codes.RESULT_MAP_DOES_NOT_EXIST),
    ):
        assert probe.call(LoadMap, "load_map", LoadMap.Request(map_url=url)).result == code, url
    assert len(late) == 1, "the map that is there stays"
    loaded = probe.call(LoadMap, "load_map", LoadMap.Request(map_url=f"file://{file}"))
    assert loaded.result == codes.RESULT_SUCCESS and loaded.map.info.width == got.occupancy.shape[1]
    probe.wait_until(lambda: len(late) == 2, what="the map that was loaded")


def test_a_map_server_whose_map_is_missing_says_so_and_does_not_start(start_node, tmp_path):
    process = start_node("tracked_localization", "map_server", "--ros-args", "-p", f"map:={tmp_path / 'nowhere.yaml'}")
    assert process.wait(START_LIMIT_S) == 1
    assert "nowhere.yaml" in process.output and "Traceback" not in process.output


def test_a_mapper_draws_the_room_it_drives_through_and_saves_it(probe, start_node, tmp_path):
    start = Pose2(1.0, 0.5, 0.3)
    stem = tmp_path / "maps" / "room"
    process = start_node(
        *("tracked_localization", "mapper", "--ros-args", "-p", "reliable_sensors:=true", "-p", f"save_to:={stem}"),
        *("-p", "initial_pose:=[1.0, 0.5, 0.3]"),
    )
    transforms, reports = probe.collect(TFMessage, "tf", KEEP), probe.collect(DiagnosticArray, "diagnostics", KEEP)
    robot = RoomRobot(probe, start)
    probe.wait_until(lambda: robot.heard, timeout_s=START_LIMIT_S, what="the mapper")
    refused = probe.call(Trigger, "save_map")
    assert not refused.success and "no scan" in refused.message
    for motion in ((0.0, 0.0), (0.3, 0.5), (0.0, 1.0), (0.3, -0.5)):
        for _ in range(20):
            robot.live(0.1, *motion)
            probe.spin(0.01)
    sent = [t for message in transforms for t in message.transforms]
    assert {(t.header.frame_id, t.child_frame_id) for t in sent} == {("map", "odom")}
    late = probe.collect(OccupancyGrid, "map", qos.LATCHED)
    probe.wait_until(lambda: late, what="the map so far")
    saved = probe.call(Trigger, "save_map")
    assert saved.success and str(stem) in saved.message
    drawn = load_map(stem.with_name("room.yaml"), "map")
    walls = drawn.centres_of(np.argwhere(drawn.occupied))
    assert len(walls) > 300 and np.mean(ROOM.distances(walls) < 0.05) > 0.99
    robot.live(1.0 / 60.0)
    robot.send_scan(range_max=math.inf, ranges=array("f", [1e30] * 360))
    robot.live(1.0 / 60.0)
    probe.wait_until(
        lambda: any("left out" in s.message for report in reports for s in report.status),
        what="a word on the huge scan",
    )
    stem.with_name("room.yaml").unlink()
    assert process.stop(signal.SIGTERM) == 0
    assert stem.with_name("room.yaml").exists() and "map saved" in process.output
