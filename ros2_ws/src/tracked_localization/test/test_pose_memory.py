import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tracked_localization.pose_memory import PoseMemory
from tracked_localization.state import SIZE


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6), late=st.integers(1, 8))
def test_on_a_linear_filter_a_late_measurement_counts_as_one_in_time_with_the_same_gains(seed, late):
    generator = np.random.default_rng(seed)
    changes = [np.eye(SIZE) + 0.05 * generator.standard_normal((SIZE, SIZE)) for _ in range(8)]
    rows = [generator.standard_normal((1, SIZE)) for _ in range(8)]
    gains = [0.1 * generator.standard_normal((SIZE, 1)) for _ in range(8)]
    values = 0.1 * generator.standard_normal(8)

    def simulate(applied_at):
        state, covariance, memory = np.zeros(SIZE), np.eye(SIZE), PoseMemory(10**9)
        memory.begin()
        for step in range(9):
            memory.mark(step, state, covariance)
            if step == 0:
                snapshot, variance = memory.nearest(0), covariance[:3, :3] + np.eye(3)
            if step == applied_at:
                memory.apply(snapshot, np.array([0.3, -0.2, 0.1]), variance, state, covariance)
            if step == 8:
                break
            keep = np.eye(SIZE) - gains[step] @ rows[step]
            state = keep @ changes[step] @ state + gains[step][:, 0] * values[step]
            covariance = keep @ changes[step] @ covariance @ changes[step].T @ keep.T + gains[step] @ gains[step].T
            memory.carry(changes[step])
            memory.correct(gains[step], rows[step])
        return state, covariance

    in_time, afterwards = simulate(0), simulate(late)
    assert afterwards[0] == pytest.approx(in_time[0], abs=1e-9)
    assert afterwards[1] == pytest.approx(in_time[1], abs=1e-9)


@given(share=st.floats(0.0, 1.0))
def test_between_two_snapshots_the_pose_lies_on_the_way_from_one_to_the_other(share):
    memory = PoseMemory(10**9)
    memory.begin()
    for stamp_ns, yaw in ((0, 3.1), (10**6, 3.3)):
        memory.mark(stamp_ns, np.array([1.0, 2.0, yaw, *np.zeros(SIZE - 3)]), np.eye(SIZE))
    found = memory.pose_between(round(share * 10**6))
    assert np.cos(found.yaw_rad - 3.1 - 0.2 * share) == pytest.approx(1.0, abs=1e-9)
    assert (found.x_m, found.y_m) == pytest.approx((1.0, 2.0))


def test_a_measurement_older_than_one_already_fused_helps_nearly_as_much_as_in_order():
    def simulate(order):
        state, covariance, memory = np.zeros(SIZE), np.eye(SIZE), PoseMemory(10**9)
        memory.begin()
        change = np.eye(SIZE) + 0.1 * np.eye(SIZE, k=1)
        for step in range(4):
            memory.mark(step, state, covariance)
            state[:] = change @ state
            covariance[:] = change @ covariance @ change.T
            memory.carry(change)
        measured = {1: np.array([0.3, -0.2, 0.1]), 3: np.array([-0.1, 0.2, 0.2])}
        for step in order:
            snapshot = memory.nearest(step)
            variance = snapshot.covariance[:3, :3] + 0.1 * np.eye(3)
            memory.apply(snapshot, measured[step] - snapshot.state[:3], variance, state, covariance)
        return covariance

    alone, in_order, reversed_order = simulate((3,)), simulate((1, 3)), simulate((3, 1))
    assert np.linalg.eigvalsh(reversed_order - in_order).min() > -1e-9, "nothing beats the right order"
    assert np.linalg.eigvalsh(alone - reversed_order).min() > -1e-9, "more knowledge is never worse"
    assert np.trace(reversed_order[:3, :3]) < 0.99 * np.trace(alone[:3, :3])
