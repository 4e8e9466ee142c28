import itertools
import math

import numpy as np
import pytest

from sim_bridge.corruption import ImuCorruption, ScanCorruption, TracksCorruption
from sim_bridge.fault_injector import FaultySensor
from sim_bridge.faults import KINDS, SENSORS, Fault, FaultRefused
from tracked_types import ImuSample, LaserScan, TrackSample

PERIOD_NS = 10
RATE_HZ = 60


def imu(k):
    return ImuSample(k * PERIOD_NS, "imu_link", np.full(3, 0.1 * k), np.full(3, 0.2 * k), np.eye(3), np.eye(3))


def scan(k):
    return LaserScan(k * PERIOD_NS, "laser", 0.0, 0.1, 0.0, 0.1, 0.1, 18.0, np.array([1.0 + k, np.inf], np.float32))


def tracks(k):
    """Belts at one and two millimetres per sample."""
    left, right = 0.001, 0.002
    return TrackSample(k * PERIOD_NS, left * k, right * k, left * RATE_HZ, right * RATE_HZ)


MAKERS = {"imu": imu, "scan": scan, "tracks": tracks}


def stream(sensor, *faults, count=20, seed=0):
    corruption = {"imu": ImuCorruption, "scan": ScanCorruption, "tracks": lambda: TracksCorruption(RATE_HZ)}[sensor]()
    faulty = FaultySensor(corruption, np.random.default_rng(seed))
    for fault in faults:
        faulty.inject(fault)
    return [faulty.update(MAKERS[sensor](k), k * PERIOD_NS) for k in range(count)]


def fault(sensor, kind, first=5, last=10, magnitude=0.0):
    return Fault(sensor, kind, first * PERIOD_NS, last * PERIOD_NS, magnitude)


def numbers(sample):
    return {
        ImuSample: lambda: sample.angular_velocity_radps,
        LaserScan: lambda: sample.ranges_m,
        TrackSample: lambda: np.array([sample.left_travel_m, sample.left_speed_mps]),
    }[type(sample)]()


@pytest.mark.parametrize("sensor", SENSORS)
def test_without_faults_samples_pass_unchanged(sensor):
    for k, delivered in enumerate(stream(sensor)):
        np.testing.assert_array_equal(numbers(delivered[0]), numbers(MAKERS[sensor](k)))


@pytest.mark.parametrize("sensor", SENSORS)
@pytest.mark.parametrize("kind", KINDS)
def test_every_fault_shows_in_every_stream_and_only_while_it_lasts(sensor, kind):
    magnitude = 3 * PERIOD_NS * 1e-9 if kind == "delay" else 0.8
    healthy, faulty = stream(sensor), stream(sensor, fault(sensor, kind, magnitude=magnitude))

    def same(k):
        return [s.stamp_ns for s in healthy[k]] == [s.stamp_ns for s in faulty[k]] and all(
            np.array_equal(numbers(a), numbers(b)) for a, b in zip(healthy[k], faulty[k], strict=True)
        )

    assert all(same(k) for k in range(5))
    assert not all(same(k) for k in range(5, 10))
    if sensor != "tracks":  # counters keep what they lost
        assert all(same(k) for k in range(13, 20))


@pytest.mark.parametrize("sensor", SENSORS)
def test_frozen_sensor_keeps_sending_fresh_stamps(sensor):
    delivered = stream(sensor, fault(sensor, "freeze"))
    assert [samples[0].stamp_ns for samples in delivered] == [k * PERIOD_NS for k in range(20)]


def test_frozen_imu_repeats_the_last_healthy_reading():
    delivered = stream("imu", fault("imu", "freeze"))
    for k in range(5, 10):
        np.testing.assert_array_equal(delivered[k][0].angular_velocity_radps, imu(4).angular_velocity_radps)


def test_frozen_encoder_stands_still_and_loses_the_way():
    delivered = [samples[0] for samples in stream("tracks", fault("tracks", "freeze"))]
    assert all(sample.left_speed_mps == 0.0 for sample in delivered[5:10])
    assert {round(sample.left_travel_m, 9) for sample in delivered[4:10]} == {0.004}
    assert delivered[10].left_travel_m == pytest.approx(0.005)


@pytest.mark.parametrize(("kind", "magnitude"), [("freeze", 0.0), ("bias", 0.03), ("jump", 0.01)])
def test_encoder_speed_stays_the_change_of_travel(kind, magnitude):
    delivered = [samples[0] for samples in stream("tracks", fault("tracks", kind, magnitude=magnitude))]
    for before, now in itertools.pairwise(delivered):
        assert now.left_speed_mps == pytest.approx((now.left_travel_m - before.left_travel_m) * RATE_HZ)


def test_gyro_bias_acts_on_the_yaw_rate_alone():
    sample = stream("imu", fault("imu", "bias", magnitude=0.2))[7][0]
    np.testing.assert_allclose(sample.angular_velocity_radps - imu(7).angular_velocity_radps, [0.0, 0.0, 0.2])


def test_jumps_go_both_ways():
    delivered = stream("imu", fault("imu", "jump", 0, 20, magnitude=1.0))
    jumps = {round(float(samples[0].angular_velocity_radps[2] - 0.1 * k), 6) for k, samples in enumerate(delivered)}
    assert jumps == {-1.0, 1.0}


def test_blackout_sends_nothing():
    assert all(not samples for samples in stream("scan", fault("scan", "blackout"))[5:10])


def test_dropout_loses_its_share():
    lost = sum(not s for s in stream("imu", Fault("imu", "dropout", magnitude=0.3), count=2000))
    assert lost == pytest.approx(600, abs=80)


def test_delay_delivers_late_with_true_stamps_and_loses_nothing():
    delivered = stream("imu", fault("imu", "delay", magnitude=3 * PERIOD_NS * 1e-9))
    assert [s.stamp_ns for s in delivered[8]] == [5 * PERIOD_NS]
    stamps = sorted(sample.stamp_ns for samples in delivered for sample in samples)
    assert stamps == [k * PERIOD_NS for k in range(20)]


def test_late_samples_arrive_although_the_sensor_has_nothing_new():
    faulty = FaultySensor(ImuCorruption(), np.random.default_rng(0))
    faulty.inject(Fault("imu", "delay", magnitude=1e-8))
    assert faulty.update(imu(1), 10) == []
    faulty.end_faults()
    assert [sample.stamp_ns for sample in faulty.update(None, 20)] == [10]


def test_faults_add_up():
    both = stream("imu", fault("imu", "bias", magnitude=0.2), fault("imu", "bias", 7, 9, magnitude=0.3))
    assert both[8][0].angular_velocity_radps[2] - imu(8).angular_velocity_radps[2] == pytest.approx(0.5)


def test_ending_faults_heals_the_sensor():
    faulty = FaultySensor(ImuCorruption(), np.random.default_rng(0))
    faulty.inject(Fault("imu", "nan"))
    assert faulty.active(0) and math.isnan(faulty.update(imu(0), 0)[0].angular_velocity_radps[0])
    faulty.end_faults()
    assert not faulty.active(1) and np.isfinite(faulty.update(imu(1), 1)[0].angular_velocity_radps).all()


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ({"sensor": "nose", "kind": "nan"}, "sensor"),
        ({"sensor": "imu", "kind": "explode"}, "kind"),
        ({"sensor": "imu", "kind": "bias", "magnitude": math.nan}, "magnitude"),
        ({"sensor": "imu", "kind": "dropout", "magnitude": 1.5}, "0 to 1"),
        ({"sensor": "imu", "kind": "delay", "magnitude": -1.0}, "delay"),
        ({"sensor": "imu", "kind": "delay", "magnitude": 1e9}, "delay"),
        ({"sensor": "imu", "kind": "nan", "start_ns": 5, "end_ns": 4}, "end"),
    ],
)
def test_senseless_faults_are_refused(arguments, named):
    with pytest.raises(FaultRefused, match=named):
        Fault(**arguments)
