import math

import pytest

from sim_bridge.scene_settings import SceneSettings
from sim_bridge.world import load_world
from tracked_types import Pose2
from tracked_types.checked_yaml import CheckedFileError


def test_the_robot_stands_at_the_start_of_that_name() -> None:
    world, start = SceneSettings(world="step").load()
    assert world.name == "step" and start == load_world("step").start()


def test_a_start_pose_counts_only_where_it_is_asked_for() -> None:
    assert SceneSettings(start="pose", start_pose=[1.0, -2.0, 0.5]).load()[1] == Pose2(1.0, -2.0, 0.5)
    assert SceneSettings(start_pose=[1.0, -2.0, 0.5]).load()[1] == load_world("flat").start()


@pytest.mark.parametrize("pose", [(), (0.0, 0.0), (0.0, 0.0, math.nan), (0.0, math.inf, 0.0), (0.0,) * 4])
def test_a_start_pose_that_is_none_is_refused(pose: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="start_pose must be three finite numbers"):
        SceneSettings(start="pose", start_pose=pose)


def test_what_the_scene_does_not_have_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match="no start 'roof'"):
        SceneSettings(start="roof").load()
    with pytest.raises(CheckedFileError, match="'moon'"):
        SceneSettings(world="moon").load()
    with pytest.raises(ValueError, match=r"SceneSettings\.seed"):
        SceneSettings(seed=-1)
