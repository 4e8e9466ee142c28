"""World files: what is packaged, and what is refused by name."""

import math

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from sim_bridge.solids import Ramp, Slats, solids_of
from sim_bridge.world import World, load_world, packaged_worlds
from tracked_types.checked_yaml import CheckedFileError

BOX = {"name": "box", "shape": "box", "size_m": [1.0, 1.0, 1.0], "position_m": [2.0, 0.0]}


def content(**changes):
    return {"name": "trial", "description": "x", "starts": {"default": {"x_m": 0.0, "y_m": 0.0}}, **changes}


def write(tmp_path, what):
    path = tmp_path / "trial.yaml"
    path.write_text(yaml.safe_dump(what))
    return path


def test_promised_worlds_are_packaged():
    assert set(packaged_worlds()) >= {"flat", "step", "slats", "ramp", "rooms", "corridor", "ice"}


@pytest.mark.parametrize("name", packaged_worlds())
def test_packaged_world_has_its_own_name_a_start_and_a_goal(name):
    world = load_world(name)
    assert world.name == name
    assert world.start() == world.start("default")
    assert world.goals


@pytest.mark.parametrize("name", packaged_worlds())
def test_starts_are_clear_of_every_obstacle(make_vehicle, name):
    world = load_world(name)
    for start in world.starts.values():
        assert drift_after_placing(make_vehicle, world, start) < 0.01


@pytest.mark.parametrize("name", ["step", "corridor", "rooms"])
def test_goals_on_the_floor_are_clear_of_every_obstacle(make_vehicle, name):
    world = load_world(name)
    for goal in world.goals.values():
        assert drift_after_placing(make_vehicle, world, goal) < 0.01


def drift_after_placing(make_vehicle, world, place):
    """How far (m) a robot put somewhere is thrown: something in the way would push it off."""
    state = make_vehicle(world, start=place.pose(), settle_s=0.5).state
    return float(np.linalg.norm(state.base_position_m - [place.x_m, place.y_m, 0.0]))


def test_world_is_read_from_a_path(tmp_path):
    assert load_world(write(tmp_path, content())).name == "trial"
    assert load_world(str(write(tmp_path, content()))).name == "trial"


def test_unknown_world_lists_the_known_ones():
    with pytest.raises(CheckedFileError, match=r"'moon'.*corridor, flat"):
        load_world("moon")


def test_missing_file_is_named():
    with pytest.raises(CheckedFileError, match=r"nowhere\.yaml"):
        load_world("nowhere.yaml")


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"objects": [{**BOX, "size_m": [1.0, -1.0, 1.0]}]}, r"objects\.0\.box\.size_m\.1"),
        ({"objects": [{**BOX, "size_m": [1.0, math.nan, 1.0]}]}, r"objects\.0\.box\.size_m\.1"),
        ({"objects": [{**BOX, "mass_kg": 0.01}]}, r"objects\.0\.box\.mass_kg"),
        ({"objects": [{**BOX, "weight": 1.0}]}, r"objects\.0\.box\.weight"),
        ({"objects": [{**BOX, "shape": "sphere"}]}, r"objects\.0.*shape"),
        ({"objects": [BOX, BOX]}, "objects and walkers: names are used twice: box"),
        ({"friction": {"longitudinal": 0.0, "lateral": 0.5}}, r"friction\.longitudinal"),
        ({"friction_zones": [{"name": "z", "centre_m": [0.0], "size_m": [1, 1]}]}, r"friction_zones\.0\.centre_m"),
        ({"starts": {}}, "starts: at least one"),
        ({"starts": {"default": {"x_m": 0.0}}}, r"starts\.default\.y_m"),
        ({"gravity": 3.0}, "gravity"),
    ],
)
def test_bad_content_names_the_offending_key(tmp_path, changes, named):
    with pytest.raises(CheckedFileError, match=rf"trial\.yaml.*{named}"):
        load_world(write(tmp_path, content(**changes)))


def test_missing_start_or_goal_lists_what_there_is():
    with pytest.raises(ValueError, match="no start 'roof'; there are: default"):
        load_world("flat").start("roof")
    with pytest.raises(ValueError, match="no goal 'roof'; there are: ahead, left"):
        load_world("flat").goal("roof")


def test_object_without_height_stands_on_the_floor():
    world = World.model_validate(content(objects=[BOX]))
    assert next(world.solids()).position_m == (2.0, 0.0, 0.5)


@given(
    length=st.floats(0.2, 3.0),
    height=st.floats(0.02, 1.0),
    yaw=st.floats(-3.1, 3.1),
    x=st.floats(-5, 5),
    y=st.floats(-5, 5),
)
def test_upper_face_of_a_ramp_rises_from_its_foot_to_its_height(length, height, yaw, x, y):
    ramp = Ramp(name="r", shape="ramp", position_m=(x, y), length_m=length, width_m=1.0, height_m=height, yaw_rad=yaw)
    (solid,) = solids_of(ramp)
    _, pitch, _ = solid.roll_pitch_yaw_rad
    for end, (along, up) in ((-0.5, (0.0, 0.0)), (0.5, (length, height))):
        forward, upward = end * solid.size_m[0], 0.5 * solid.size_m[2]
        horizontal = forward * math.cos(pitch) + upward * math.sin(pitch)
        vertical = -forward * math.sin(pitch) + upward * math.cos(pitch)
        offset = (horizontal * math.cos(yaw), horizontal * math.sin(yaw), vertical)
        place = np.add(solid.position_m, offset)
        assert place == pytest.approx([x + along * math.cos(yaw), y + along * math.sin(yaw), up], abs=1e-9)


def test_slats_repeat_with_their_seed_and_stay_within_their_heights():
    def row(seed):
        return list(
            solids_of(
                Slats(
                    name="s",
                    shape="slats",
                    position_m=(1.0, 0.0),
                    count=20,
                    spacing_m=0.2,
                    length_m=0.05,
                    width_m=1.0,
                    height_min_m=0.004,
                    height_max_m=0.014,
                    seed=seed,
                )
            )
        )

    assert row(1) == row(1) != row(2)
    assert all(0.004 <= solid.size_m[2] <= 0.014 for solid in row(1))
    assert [solid.name for solid in row(1)][:2] == ["s_0", "s_1"]
