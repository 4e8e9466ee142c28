import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim_bridge.sensors.imu import ImuSensor
from sim_bridge.sensors.mounting import Mounting
from sim_bridge.sensors.rotations import rotation_from_vector, vector_of_rotation
from tracked_description import load_robot

ROBOT = load_robot()
PERIOD_S = 1.0 / ROBOT.imu.rate_hz
QUIET = {
    "gyro_noise_radps": 0.0,
    "gyro_bias_radps": 0.0,
    "gyro_bias_walk_radps_sqrt_s": 0.0,
    "acceleration_noise_mps2": 0.0,
    "acceleration_bias_mps2": 0.0,
}


def sensor(start, seed=0, **changes):
    return ImuSensor(ROBOT.imu.model_copy(update=changes), "imu_link", np.random.default_rng(seed), start)


def test_level_and_at_rest_it_reads_gravity_upwards(motion):
    sample = sensor(motion(), **QUIET).update(motion(), 1)
    np.testing.assert_allclose(sample.linear_acceleration_mps2, [0.0, 0.0, 9.81])
    np.testing.assert_allclose(sample.angular_velocity_radps, np.zeros(3), atol=1e-12)
    assert (sample.stamp_ns, sample.frame_id) == (1, "imu_link")


def test_pitched_nose_down_it_reads_gravity_behind_and_above(motion):
    tilted = motion(rpy=(0.0, 0.3, 0.0))
    reading = sensor(tilted, **QUIET).update(tilted, 1).linear_acceleration_mps2
    np.testing.assert_allclose(reading, 9.81 * np.array([-np.sin(0.3), 0.0, np.cos(0.3)]))


@given(st.lists(st.tuples(*[st.floats(-2.0, 2.0)] * 6), min_size=2, max_size=12))
def test_its_integrals_are_the_changes_of_velocity_and_orientation(motion, states):
    motions = [motion(velocity=s[:3], rpy=(0.1 * s[3], 0.1 * s[4], s[5] * 0.2)) for s in states]
    imu = sensor(motions[0], **QUIET)
    velocity, rotation = motions[0].velocity_mps, motions[0].rotation
    for now in motions[1:]:
        sample = imu.update(now, 1)
        turn = sample.angular_velocity_radps * PERIOD_S
        middle = rotation @ rotation_from_vector(0.5 * turn)
        velocity = velocity + (middle @ sample.linear_acceleration_mps2 - [0.0, 0.0, 9.81]) * PERIOD_S
        rotation = rotation @ rotation_from_vector(turn)
    np.testing.assert_allclose(velocity, motions[-1].velocity_mps, atol=1e-9)
    np.testing.assert_allclose(vector_of_rotation(rotation.T @ motions[-1].rotation), np.zeros(3), atol=1e-7)


def test_off_centre_mounting_feels_the_centripetal_force(motion, circling):
    rate, arm = 1.3, Mounting(np.array([0.2, 0.0, 0.0]), np.eye(3))
    spin = [arm.motion(circling(k * PERIOD_S, rate, 0.0)) for k in range(2)]
    reading = sensor(spin[0], **QUIET).update(spin[1], 1).linear_acceleration_mps2
    np.testing.assert_allclose(reading, [-(rate**2) * 0.2, 0.0, 9.81], rtol=1e-4, atol=1e-12)


def test_mounting_follows_the_description(motion):
    robot = ROBOT.model_copy(update={"imu": ROBOT.imu.model_copy(update={"rpy_rad": (0.0, 0.0, np.pi / 2)})})
    mounted = Mounting.of_sensor(robot.imu, robot).motion(motion(position=(1.0, 2.0, 0.17), rates=(0.0, 0.0, 1.0)))
    np.testing.assert_allclose(mounted.position_m, [1.05, 2.0, 0.2], atol=1e-12)
    np.testing.assert_allclose(mounted.velocity_mps, [0.0, 0.05, 0.0], atol=1e-12)
    np.testing.assert_allclose(mounted.rotation[:, 0], [0.0, 1.0, 0.0], atol=1e-12)


def test_being_put_elsewhere_is_no_movement(motion):
    imu = sensor(motion(), **QUIET)
    moved = motion(position=(5.0, 0.0, 0.0), rpy=(0.0, 0.0, 2.0))
    imu.restart(moved)
    np.testing.assert_allclose(imu.update(moved, 1).angular_velocity_radps, np.zeros(3), atol=1e-12)


def test_noise_bias_and_covariance_agree(motion):
    imu = sensor(motion(), gyro_bias_walk_radps_sqrt_s=0.0)
    samples = [imu.update(motion(), k) for k in range(4000)]
    rates = np.array([sample.angular_velocity_radps for sample in samples])
    forces = np.array([sample.linear_acceleration_mps2 for sample in samples])
    np.testing.assert_allclose(rates.mean(0), ROBOT.imu.gyro_bias_radps, atol=6e-4)
    np.testing.assert_allclose(rates.var(0), np.diag(samples[0].angular_velocity_covariance), rtol=0.1)
    np.testing.assert_allclose(forces.var(0), np.diag(samples[0].linear_acceleration_covariance), rtol=0.1)


def test_gyro_bias_walks_as_the_description_says(motion):
    walks = []
    for seed in range(60):
        imu = sensor(motion(), seed)
        start = imu.gyro_bias_radps
        for k in range(ROBOT.imu.rate_hz):
            imu.update(motion(), k)
        walks.append(imu.gyro_bias_radps - start)
    assert np.std(walks) == pytest.approx(ROBOT.imu.gyro_bias_walk_radps_sqrt_s, rel=0.2)
