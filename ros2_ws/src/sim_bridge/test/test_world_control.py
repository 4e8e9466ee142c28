import math

import numpy as np
import pytest

from sim_bridge.entities import EntityError, EntityState
from sim_bridge.simulator import Simulator
from sim_bridge.world import load_world
from sim_bridge.world_control import UnknownNameError, WorldControl
from tracked_description import load_robot

ROBOT = load_robot()
NO_TURN = (0.0, 0.0, 0.0)


@pytest.fixture
def simulator():
    made = Simulator(ROBOT, load_world("ice"))
    yield made
    made.close()


@pytest.fixture
def control(simulator):
    return WorldControl(simulator)


def spawn_crate(control, name="crate", size=(0.2, 0.2, 0.2), mass=1.0, position=(2.0, 1.0, 0.1), shape="box"):
    control.spawn(name, shape, size, mass, position, NO_TURN)


def test_robot_is_the_first_entity_and_stands_at_its_start(control):
    assert control.entity_names[0] == ROBOT.name
    assert control.entity_state(ROBOT.name).position_m == pytest.approx((0.0, 0.0, 0.0), abs=1e-6)


def test_spawned_body_is_there_until_deleted(control):
    before = control.entity_names
    spawn_crate(control)
    assert control.entity_names == (*before, "crate")
    assert control.entity_state("crate").position_m == pytest.approx((2.0, 1.0, 0.1))
    control.delete("crate")
    assert control.entity_names == before


def test_lidar_sees_a_spawned_cylinder(control, simulator):
    control.spawn("post", "cylinder", (0.2, 0.2, 1.0), 0.0, (1.0, 0.0, 0.5), NO_TURN)
    scan = [scan for _ in range(12) for scan in simulator.advance().scans][-1]
    ahead = scan.ranges_m[len(scan.ranges_m) // 2]
    assert ahead == pytest.approx(1.0 - 0.1 - ROBOT.lidar.xyz_m[0], abs=0.02)


def test_robot_can_be_put_elsewhere_and_lands_on_the_floor(control):
    control.set_entity_state(ROBOT.name, EntityState((1.5, -0.5, 7.0), (0.3, 0.3, 1.0)))
    state = control.entity_state(ROBOT.name)
    assert state.position_m == pytest.approx((1.5, -0.5, 0.0), abs=1e-6)
    assert state.roll_pitch_yaw_rad == pytest.approx((0.0, 0.0, 1.0), abs=1e-9)


def test_placing_the_robot_keeps_what_the_operator_changed(control, simulator):
    spawn_crate(control)
    control.set_suspension("locked")
    control.set_entity_state(ROBOT.name, EntityState((1.0, 0.0, 0.0), NO_TURN))
    assert "crate" in control.entity_names
    assert simulator.vehicle.suspension == "locked"


def test_reset_undoes_everything(control, simulator):
    names = control.entity_names
    spawn_crate(control)
    control.set_suspension("linear")
    simulator.reset(1)
    assert control.entity_names == names
    assert simulator.vehicle.suspension == ROBOT.suspension.kind


def test_friction_of_a_zone_can_be_changed(control, simulator):
    zone = simulator.world.friction_zones[0].name
    control.set_friction(zone, 0.3, 0.2)
    control.set_friction("", 0.6, 0.5)
    with pytest.raises(UnknownNameError, match=zone):
        control.set_friction("lava", 0.3, 0.2)
    with pytest.raises(ValueError, match="lateral"):
        control.set_friction("", 0.3, math.nan)


@pytest.mark.parametrize("name", ["ghost", "", "rob\x00ot"])
def test_unknown_entities_are_named_with_those_that_exist(control, name):
    for act in (control.entity_state, control.delete):
        with pytest.raises(UnknownNameError, match=ROBOT.name):
            act(name)
    with pytest.raises(UnknownNameError):
        control.set_entity_state(name, EntityState(NO_TURN, NO_TURN))


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"shape": "teapot"}, "box or cylinder"),
        ({"size": (0.2, -0.2, 0.2)}, "size_m"),
        ({"size": (0.2, math.nan, 0.2)}, "size_m"),
        ({"size": (0.2, 0.3, 0.2), "shape": "cylinder"}, "diameter"),
        ({"mass": -1.0}, "mass_kg"),
        ({"mass": 1e-9}, "mass_kg"),
        ({"mass": math.inf}, "mass_kg"),
        ({"position": (math.nan, 0.0, 0.0)}, "position_m"),
        ({"name": ""}, "name"),
        ({"name": "two words"}, "name"),
        ({"name": ROBOT.name}, "robot"),
    ],
)
def test_impossible_bodies_are_refused_and_nothing_is_added(control, changes, named):
    before = control.entity_names
    with pytest.raises(ValueError, match=named):
        spawn_crate(control, **changes)
    assert control.entity_names == before


def test_a_name_is_given_once(control):
    spawn_crate(control)
    with pytest.raises(EntityError, match="crate"):
        spawn_crate(control)


def test_robot_cannot_be_deleted_nor_put_nowhere(control):
    with pytest.raises(EntityError, match="robot"):
        control.delete(ROBOT.name)
    with pytest.raises(EntityError, match="finite"):
        control.set_entity_state(ROBOT.name, EntityState((math.nan, 0.0, 0.0), NO_TURN))
    assert np.all(np.isfinite(control.entity_state(ROBOT.name).position_m))


def test_unknown_suspension_is_refused(control):
    with pytest.raises(UnknownNameError, match="qzs, linear, locked"):
        control.set_suspension("jelly")
