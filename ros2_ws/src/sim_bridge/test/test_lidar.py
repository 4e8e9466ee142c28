import numpy as np
import pytest

from sim_bridge.sensors.lidar import LidarSensor
from tracked_description import load_robot

MODEL = load_robot().lidar
QUIET = MODEL.model_copy(update={"noise_m": 0.0})
TICK_RATE_HZ = 120
TICKS = TICK_RATE_HZ // MODEL.rate_hz


def wall_ahead(distance_m):
    """A plane x = distance in the world."""

    def cast(origins, ends):
        way = ends[:, 0] - origins[:, 0]
        share = np.full(len(ends), 1.0)
        towards = way > 1e-9
        share[towards] = np.clip((distance_m - origins[towards, 0]) / way[towards], 0.0, 1.0)
        return share

    return cast


def revolution(mode, motions, cast, model=QUIET, first_tick=0):
    lidar = LidarSensor(model, "laser", mode, TICK_RATE_HZ, np.random.default_rng(0), motions[0])
    scans = [lidar.update(state, first_tick + k, cast) for k, state in enumerate(motions[1:], 1)]
    assert all(scan is None for scan in scans[:-1])
    return scans[-1]


def bearing_of_nearest(scan):
    return scan.angle_min_rad + int(np.argmin(scan.ranges_m)) * scan.angle_increment_rad


@pytest.mark.parametrize("mode", ["instant", "rolling"])
def test_wall_is_seen_at_its_distance_and_nothing_behind(motion, mode):
    scan = revolution(mode, [motion()] * (TICKS + 1), wall_ahead(2.0))
    beams = np.arange(MODEL.beams) * scan.angle_increment_rad + scan.angle_min_rad
    ahead = np.cos(beams) > 0.2
    np.testing.assert_allclose(scan.ranges_m[ahead], 2.0 / np.cos(beams[ahead]), rtol=1e-6)
    assert np.all(scan.ranges_m[np.cos(beams) < 0.0] == np.inf)


def test_object_too_close_reads_minus_infinity(motion):
    scan = revolution("instant", [motion()] * (TICKS + 1), wall_ahead(0.5 * MODEL.range_min_m))
    assert scan.ranges_m[MODEL.beams // 2] == -np.inf


def test_noise_never_leaves_the_measuring_range(motion):
    model = MODEL.model_copy(update={"noise_m": 0.5})
    for distance in (MODEL.range_min_m, MODEL.range_max_m - 0.01):
        ranges = revolution("instant", [motion()] * (TICKS + 1), wall_ahead(distance), model).ranges_m
        finite = ranges[np.isfinite(ranges)]
        assert np.all((finite >= np.float32(MODEL.range_min_m)) & (finite <= np.float32(MODEL.range_max_m)))


def test_rolling_scan_is_stamped_with_its_first_beam_and_instant_scan_with_all(motion):
    still = [motion()] * (TICKS + 1)
    rolling, instant = (revolution(mode, still, wall_ahead(2.0), first_tick=TICKS) for mode in ("rolling", "instant"))
    assert (rolling.stamp_ns, instant.stamp_ns) == (100_000_000, 200_000_000)
    assert instant.time_increment_s == 0.0
    assert rolling.time_increment_s * MODEL.beams == pytest.approx(rolling.scan_time_s)


def test_rotation_skews_a_rolling_scan_by_the_turn_since_its_beam(circling):
    rate = 1.3
    spin = [circling(k / TICK_RATE_HZ, rate, 0.0) for k in range(TICKS + 1)]
    model = QUIET.model_copy(update={"beams": 3600})
    end_yaw = rate / MODEL.rate_hz
    assert bearing_of_nearest(revolution("instant", spin, wall_ahead(2.0), model)) == pytest.approx(-end_yaw, abs=2e-3)
    # The beam that meets the wall squarely fires when the sensor has turned through its bearing.
    share = np.pi / (2.0 * np.pi + end_yaw)
    skewed = bearing_of_nearest(revolution("rolling", spin, wall_ahead(2.0), model))
    assert skewed == pytest.approx(-end_yaw * share, abs=2e-3)


def test_translation_stretches_a_rolling_scan(motion):
    drive = [motion(position=(0.5 * k / TICK_RATE_HZ, 0.0, 0.0)) for k in range(TICKS + 1)]
    scan = revolution("rolling", drive, wall_ahead(2.0))
    assert scan.ranges_m[MODEL.beams // 2] == pytest.approx(2.0 - 0.5 * 0.5 / MODEL.rate_hz, abs=1e-6)


def test_beams_that_did_not_fire_are_invalid(motion):
    half = TICKS // 2
    lidar = LidarSensor(QUIET, "laser", "rolling", TICK_RATE_HZ, np.random.default_rng(0), motion())
    scans = [lidar.update(motion(), tick, wall_ahead(2.0)) for tick in range(half + 1, TICKS + 1)]
    assert np.isnan(scans[-1].ranges_m).sum() == MODEL.beams // 2


def test_beams_need_not_divide_evenly(motion):
    model = QUIET.model_copy(update={"beams": 367})
    scan = revolution("rolling", [motion()] * (TICKS + 1), wall_ahead(2.0), model)
    assert scan.ranges_m.shape == (367,)
    assert not np.isnan(scan.ranges_m).any()


@pytest.mark.parametrize(("mode", "rate"), [("sideways", 120), ("instant", 125)])
def test_impossible_settings_are_refused(motion, mode, rate):
    with pytest.raises(ValueError, match="lidar"):
        LidarSensor(MODEL, "laser", mode, rate, np.random.default_rng(0), motion())
