"""Bodies of a running world by name."""

import math

import pybullet
import pytest

from sim_bridge.entities import EntityError, EntityState
from sim_bridge.solids import Solid

CRATE = Solid("crate", "box", (0.2, 0.2, 0.2), (1.0, 2.0, 0.1), mass_kg=1.0)
PILLAR = Solid("pillar", "cylinder", (0.4, 0.4, 1.0), (3.0, 0.0, 0.5))


def rays(vehicle, start, end):
    return pybullet.rayTest(start, end, physicsClientId=vehicle.client)[0]


def test_spawned_entity_is_where_it_was_put(make_vehicle):
    vehicle = make_vehicle(settle_s=0.0)
    vehicle.entities.spawn(CRATE)
    assert vehicle.entities.names == ("crate",)
    assert vehicle.entities.state("crate").position_m == pytest.approx((1.0, 2.0, 0.1))
    assert vehicle.entities.solid("crate") is CRATE


def test_second_of_the_same_name_is_refused(make_vehicle):
    vehicle = make_vehicle(settle_s=0.0)
    vehicle.entities.spawn(CRATE)
    with pytest.raises(EntityError, match="already an entity 'crate'"):
        vehicle.entities.spawn(CRATE)


def test_deleted_entity_is_gone_and_others_stay(make_vehicle, drive):
    vehicle = make_vehicle(settle_s=0.0)
    for solid in (CRATE, PILLAR):
        vehicle.entities.spawn(solid)
    vehicle.entities.delete("crate")
    assert vehicle.entities.names == ("pillar",)
    drive(vehicle, 0.3, 0.3, 0.1)
    assert vehicle.entities.state("pillar").position_m == pytest.approx(PILLAR.position_m)


@pytest.mark.parametrize("operation", ["delete", "state", "solid"])
def test_unknown_name_is_refused_with_the_known_ones(make_vehicle, operation):
    vehicle = make_vehicle(settle_s=0.0)
    vehicle.entities.spawn(CRATE)
    with pytest.raises(EntityError, match="no entity 'ghost'; there are: crate"):
        getattr(vehicle.entities, operation)("ghost")


def test_moved_entity_keeps_its_new_state(make_vehicle, drive):
    vehicle = make_vehicle(settle_s=0.0)
    vehicle.entities.spawn(PILLAR)
    vehicle.entities.set_state("pillar", EntityState((0.0, 3.0, 0.5), (0.0, 0.0, 1.0)))
    drive(vehicle, 0.0, 0.0, 0.2)
    state = vehicle.entities.state("pillar")
    assert state.position_m == pytest.approx((0.0, 3.0, 0.5))
    assert state.roll_pitch_yaw_rad == pytest.approx((0.0, 0.0, 1.0))


def test_thrown_entity_flies(make_vehicle, drive):
    vehicle = make_vehicle(settle_s=0.0)
    vehicle.entities.spawn(CRATE)
    vehicle.entities.set_state("crate", EntityState((1.0, 2.0, 2.0), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)))
    drive(vehicle, 0.0, 0.0, 0.1)
    state = vehicle.entities.state("crate")
    assert state.velocity_mps[0] == pytest.approx(1.0, abs=0.01)
    assert state.position_m[2] < 2.0


@pytest.mark.parametrize("bad", [(math.nan, 0.0, 0.0), (0.0, math.inf, 0.0), (0.0, 0.0)])
def test_state_that_is_no_number_is_refused(make_vehicle, bad):
    vehicle = make_vehicle(settle_s=0.0)
    vehicle.entities.spawn(CRATE)
    with pytest.raises(EntityError, match="crate"):
        vehicle.entities.set_state("crate", EntityState(bad, (0.0, 0.0, 0.0)))
    assert vehicle.entities.state("crate").position_m == pytest.approx(CRATE.position_m)


def test_rays_see_the_world_but_never_the_robot(make_vehicle):
    vehicle = make_vehicle()
    vehicle.entities.spawn(PILLAR)
    for height in (0.02, 0.08, 0.17, 0.22):
        assert rays(vehicle, (-2.0, 0.0, height), (2.0, 0.0, height))[0] == -1
        hit = rays(vehicle, (-2.0, 0.0, height), (4.0, 0.0, height))
        assert hit[3][0] == pytest.approx(2.8, abs=1e-6)


def test_sleeping_never_makes_a_crate_deaf(make_vehicle, drive):
    vehicle = make_vehicle()
    vehicle.entities.spawn(Solid("crate", "box", (0.3, 0.3, 0.3), (0.6, 0.0, 0.15), mass_kg=2.0))
    drive(vehicle, 0.0, 0.0, 10.0)
    drive(vehicle, 0.3, 0.3, 2.0)
    assert vehicle.entities.state("crate").position_m[0] > 0.7
