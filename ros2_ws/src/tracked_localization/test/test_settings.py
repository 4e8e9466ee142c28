import pytest

from tracked_localization import OdometryFilterSettings, SlipSettings


def test_numbers_of_the_robot_come_from_its_file(robot):
    settings = OdometryFilterSettings.from_robot(robot)
    assert settings.gauge_m == settings.slip.gauge_m == robot.tracks.gauge_m
    assert settings.imu_up_axis == pytest.approx((0.0, 0.0, 1.0))
    both_belts = 2.0 * robot.tracks.acceleration_limit_mps2 / robot.tracks.gauge_m
    assert settings.body_yaw_acceleration_radps2 == pytest.approx(both_belts)


def test_slip_settings_given_are_used(robot):
    slip = SlipSettings.from_robot(robot, standstill_track_speed_mps=0.1)
    assert OdometryFilterSettings.from_robot(robot, slip).slip is slip


@pytest.mark.parametrize(
    ("name", "value"),
    [("patience_s", -0.1), ("silence_s", float("nan")), ("stuck_samples", -1), ("belt_yaw_ratio_deviation", 2.0)],
)
def test_value_out_of_range_is_named(robot, name, value):
    with pytest.raises(ValueError, match=name):
        OdometryFilterSettings.from_robot(robot, **{name: value})


def test_unknown_tuning_is_refused(robot):
    with pytest.raises(TypeError, match="gyro_nose"):
        OdometryFilterSettings.from_robot(robot, gyro_nose=1.0)
