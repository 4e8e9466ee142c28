"""What conditions make of the belt world."""

from typing import Any

import numpy as np
import pytest

from sim_bridge.solids import Friction
from sim_bridge.world import FrictionZone, load_world
from tracked_description import load_robot
from tracked_lab.belt_ground import STRONGEST_NM, BeltGround, YawObstacle
from tracked_lab.belt_world import BeltWorld
from tracked_lab.conditions import Conditions
from tracked_types import Twist2, VelocityCommand
from tracked_types.checked_yaml import CheckedFileError

ROBOT = load_robot()
BEGIN_S = 0.0


def driven(seconds: float = 2.0, twist: Twist2 | None = None, seed: int = 4, **conditions: Any):
    """True states and slips (n, 2) of a world under a constant command, and its start."""
    world = BeltWorld(ROBOT, {"seed": seed}, (), Conditions(**conditions), BEGIN_S)
    states, slips = [], []
    try:
        for _ in range(round(seconds * ROBOT.imu.rate_hz)):
            world.submit(VelocityCommand(world.stamp_ns, twist or Twist2(0.3, 0.6)))
            batch = world.advance()
            states.extend(batch.truth)
            slips.extend([slip.speed_mps, slip.yaw_rate_radps] for slip in batch.truth_slip)
        return states, np.array(slips), world.start
    finally:
        world.close()


def yaw_rates(states) -> np.ndarray:
    return np.array([state.twist.yaw_rate_radps for state in states])


def test_severity_two_loses_about_twice_the_yaw():
    lost = [driven(slip_severity=severity)[1][60:, 1].mean() for severity in (0.5, 1.0, 2.0)]
    assert 1.8 < lost[2] / lost[1] < 2.5
    assert 0.3 < lost[0] / lost[1] < 0.6


def test_plain_ground_is_that_of_the_world_for_every_seed():
    assert BeltGround.under(Conditions(), 7) == BeltGround()
    first, second = driven(0.5, seed=1), driven(0.5, seed=2)
    assert [state.pose for state in first[0]] == [state.pose for state in second[0]]


def test_varied_ground_differs_from_seed_to_seed_and_repeats_bit_for_bit():
    first, again, other = (driven(1.0, seed=seed, varied_ground=True) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first[1], again[1])
    assert first[2] == again[2] != other[2]
    assert not np.allclose(first[1], other[1], atol=1e-4)
    grounds = [BeltGround.under(Conditions(varied_ground=True), seed) for seed in range(50)]
    assert all(0.85 <= ground.along <= 1.15 and 0.85 <= ground.across <= 1.15 for ground in grounds)
    assert all(ground.moved is not None and abs(ground.moved.x_m) <= 0.03 for ground in grounds)


def test_friction_zones_are_scaled_like_the_floor():
    zone = FrictionZone(
        name="ice", centre_m=(0.0, 0.0), size_m=(1.0, 1.0), friction=Friction(longitudinal=0.2, lateral=0.1)
    )
    world = load_world("flat").model_copy(update={"friction_zones": (zone,)})
    seen = {}

    class Recorder:
        def set_friction(self, friction: Friction, name: str | None) -> None:
            seen[name] = (friction.longitudinal, friction.lateral)

    BeltGround(across=2.0).apply(Recorder(), world, ROBOT)  # type: ignore[arg-type]
    assert seen == {None: (0.75, 1.3), "ice": (0.2, 0.2)}


@pytest.mark.parametrize(("severity", "wrong"), [(0.0, "above zero"), (4.0, "lateral")])
def test_a_severity_that_belts_cannot_have_is_refused(severity, wrong):
    with pytest.raises((ValueError, CheckedFileError), match=wrong):
        driven(0.1, slip_severity=severity)


def test_the_obstacle_turns_the_robot_within_its_window():
    plain, turned = (yaw_rates(driven(3.0, Twist2(0.3, 0.0), obstacle=on)[0]) for on in (False, True))
    times = (np.arange(len(plain)) + 1) / ROBOT.odometry.rate_hz
    np.testing.assert_array_equal(plain[times <= 1.6], turned[times <= 1.6])
    during = turned[(times > 1.6) & (times < 2.2)]
    wanted = YawObstacle.of_seed(4, BEGIN_S).turn_radps
    assert 0.7 * abs(wanted) < np.abs(during).max() < 1.1 * abs(wanted)
    assert np.sign(during[len(during) // 2]) == np.sign(wanted)
    assert np.abs(turned[times > 2.7]).max() < 0.05


def test_the_obstacle_is_no_stronger_than_it_says_and_lets_go():
    obstacle = YawObstacle(0.8, 1.6, 2.2)
    assert obstacle.torque_nm(1.9, -5.0) == STRONGEST_NM
    assert obstacle.torque_nm(1.9, 5.0) == -STRONGEST_NM
    assert obstacle.torque_nm(1.5, 0.0) == obstacle.torque_nm(2.3, 0.0) == 0.0
