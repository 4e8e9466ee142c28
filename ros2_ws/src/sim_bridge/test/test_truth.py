import numpy as np
import pytest

from sim_bridge.sensors.truth import BaseMotion, TruthObserver

RATE_HZ, GAUGE_M = 60, 0.36


def test_slip_is_ground_motion_less_belt_motion(circling):
    rate, radius = 0.8, 0.5
    belt_rate, belt_speed = 1.0, 0.45
    states = [
        BaseMotion(
            circling(k / RATE_HZ, rate, radius),
            (belt_speed - 0.5 * GAUGE_M * belt_rate) * k / RATE_HZ,
            (belt_speed + 0.5 * GAUGE_M * belt_rate) * k / RATE_HZ,
        )
        for k in range(2)
    ]
    _, slip = TruthObserver(GAUGE_M, RATE_HZ, states[0]).update(states[1], 7)
    assert slip.speed_mps == pytest.approx(rate * radius - belt_speed, abs=1e-5)
    assert slip.yaw_rate_radps == pytest.approx(rate - belt_rate, abs=1e-9)
    assert slip.known and slip.stamp_ns == 7


def test_sideways_motion_is_no_forward_slip(motion):
    start, end = (BaseMotion(motion(position=(0.0, y, 0.0)), 0.0, 0.0) for y in (0.0, 0.01))
    _, slip = TruthObserver(GAUGE_M, RATE_HZ, start).update(end, 0)
    assert slip.speed_mps == pytest.approx(0.0, abs=1e-12)


def test_velocities_are_in_the_base_frame_and_acceleration_is_the_mean_over_the_period(motion):
    start = BaseMotion(motion(rpy=(0.0, 0.0, np.pi / 2)), 0.0, 0.0)
    end = BaseMotion(motion(rpy=(0.0, 0.0, np.pi / 2), velocity=(0.0, 0.4, 0.05), rates=(0.0, 0.0, 0.3)), 0.0, 0.0)
    state, _ = TruthObserver(GAUGE_M, RATE_HZ, start).update(end, 0)
    np.testing.assert_allclose(state.velocity_mps, [0.4, 0.0, 0.05], atol=1e-12)
    assert state.twist.yaw_rate_radps == pytest.approx(0.3)
    assert state.vertical_acceleration_mps2 == pytest.approx(0.05 * RATE_HZ)
    assert state.pose.yaw_rad == pytest.approx(np.pi / 2)


def test_being_put_elsewhere_is_no_slip(motion):
    observer = TruthObserver(GAUGE_M, RATE_HZ, BaseMotion(motion(), 0.0, 0.0))
    moved = BaseMotion(motion(position=(3.0, 0.0, 0.0), rpy=(0.0, 0.0, 1.0)), 0.0, 0.0)
    observer.restart(moved)
    _, slip = observer.update(moved, 0)
    assert (slip.speed_mps, slip.yaw_rate_radps) == (0.0, 0.0)
