"""The same inputs give the same bits; snapshots return to them."""

import hashlib

import numpy as np
import pytest

from sim_bridge.entities import EntityState
from sim_bridge.solids import Friction, Solid
from tracked_types import Pose2


def fingerprint(vehicle, steps=960, seed=0):
    """Hash of every state while the belts follow seeded targets."""
    targets = np.random.default_rng(seed).uniform(-0.5, 0.5, (steps // 48, 2))
    digest = hashlib.sha256()
    for left, right in targets.tolist():
        for _ in range(48):
            vehicle.step(left, right)
        state = vehicle.state
        for values in (state.position_m, state.quaternion, state.velocity_mps, state.suspension_travel_m):
            digest.update(values.tobytes())
        digest.update(state.belt_travel_m.tobytes())
    return digest.hexdigest()


@pytest.mark.parametrize("world", ["flat", "rooms", "slats"])
def test_two_vehicles_with_the_same_inputs_agree_to_the_bit(make_vehicle, world):
    assert fingerprint(make_vehicle(world)) == fingerprint(make_vehicle(world))


def test_other_inputs_give_other_bits(make_vehicle):
    assert fingerprint(make_vehicle(), seed=1) != fingerprint(make_vehicle(), seed=2)


def test_reset_vehicle_is_as_good_as_new(make_vehicle):
    used = make_vehicle("rooms")
    used.set_friction(Friction(longitudinal=0.2, lateral=0.2))
    used.set_suspension("linear")
    used.entities.spawn(Solid("extra", "box", (0.2, 0.2, 0.2), (2.0, 1.2, 0.1), mass_kg=1.0))
    fingerprint(used)
    used.reset()
    fresh = make_vehicle("rooms", settle_s=0.0)
    assert used.suspension == fresh.suspension
    assert fingerprint(used) == fingerprint(fresh)


@pytest.mark.parametrize("world", ["flat", "step", "rooms"])
def test_restored_snapshot_continues_to_the_bit(make_vehicle, world):
    vehicle = make_vehicle(world)
    fingerprint(vehicle, seed=3)
    snapshot = vehicle.snapshot()
    first = fingerprint(vehicle)
    vehicle.restore(snapshot)
    assert fingerprint(vehicle) == first
    vehicle.discard(snapshot)


def test_snapshot_keeps_law_friction_and_time(make_vehicle):
    vehicle = make_vehicle("ice")
    snapshot, index = vehicle.snapshot(), vehicle.step_index
    first = fingerprint(vehicle)
    vehicle.set_suspension("linear")
    vehicle.set_friction(Friction(longitudinal=0.2, lateral=0.2))
    vehicle.set_friction(Friction(longitudinal=0.2, lateral=0.2), "sheet")
    vehicle.restore(snapshot)
    assert vehicle.suspension == "qzs" and vehicle.step_index == index
    assert fingerprint(vehicle) == first


def test_snapshot_of_another_set_of_bodies_is_refused(make_vehicle):
    vehicle = make_vehicle()
    snapshot = vehicle.snapshot()
    vehicle.entities.spawn(Solid("extra", "box", (0.2, 0.2, 0.2), (2.0, 0.0, 0.1)))
    with pytest.raises(ValueError, match="spawned or deleted"):
        vehicle.restore(snapshot)


def test_snapshot_is_refused_when_a_body_of_the_same_name_is_another_one(make_vehicle):
    vehicle = make_vehicle()
    crate = Solid("crate", "box", (0.2, 0.2, 0.2), (2.0, 0.0, 0.1))
    vehicle.entities.spawn(crate)
    snapshot = vehicle.snapshot()
    vehicle.entities.delete("crate")
    vehicle.entities.spawn(crate)
    with pytest.raises(ValueError, match="spawned or deleted"):
        vehicle.restore(snapshot)


def test_snapshot_from_before_a_reset_is_refused(make_vehicle):
    vehicle = make_vehicle()
    snapshot = vehicle.snapshot()
    vehicle.reset()
    with pytest.raises(ValueError, match="reset"):
        vehicle.restore(snapshot)


def test_restored_snapshot_puts_moved_obstacles_back(make_vehicle, drive):
    vehicle = make_vehicle("step")
    snapshot = vehicle.snapshot()
    vehicle.entities.set_state("step", EntityState((9.0, 9.0, 0.02), (0.0, 0.0, 0.0)))
    vehicle.restore(snapshot)
    assert drive(vehicle, 0.5, 0.5, 2.8).roll_pitch_yaw_rad[1] < -0.05


def test_teleport_leaves_encoders_and_world_alone(make_vehicle, drive):
    vehicle = make_vehicle("rooms")
    before = drive(vehicle, 0.3, 0.3, 1.0).belt_travel_m
    vehicle.place(Pose2(2.0, 4.5, 1.0))
    state = vehicle.state
    assert state.base_pose.as_array() == pytest.approx([2.0, 4.5, 1.0])
    assert np.array_equal(state.belt_travel_m, before)
    assert not state.velocity_mps.any() and not state.belt_speed_mps.any()
