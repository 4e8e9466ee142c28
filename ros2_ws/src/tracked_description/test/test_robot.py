import pytest
import yaml

from tracked_description import load_robot
from tracked_types.checked_yaml import CheckedFileError


def packaged_content():
    return yaml.safe_load(load_robot().model_dump_json())


def write(tmp_path, content):
    path = tmp_path / "robot.yaml"
    path.write_text(yaml.safe_dump(content))
    return path


def test_packaged_robot_loads_and_round_trips(tmp_path):
    assert load_robot(write(tmp_path, packaged_content())) == load_robot()


@pytest.mark.parametrize(
    ("section", "key", "value"),
    [
        ("tracks", "gauge_m", -0.3),
        ("tracks", "gauge_m", float("nan")),
        ("tracks", "wheel_count", 2.5),
        ("tracks", "idler_x_m", 0.1),
        ("suspension", "kind", "magic"),
        ("limits", "speed_min_mps", 0.1),
        ("lidar", "beams", 0),
        ("imu", "xyz_m", [0.0, 1.0]),
        ("frames", "odom", "od om"),
    ],
)
def test_bad_value_is_refused_with_its_key(tmp_path, section, key, value):
    content = packaged_content()
    content[section][key] = value
    with pytest.raises(CheckedFileError, match=f"{section}.*{key}|{key}"):
        load_robot(write(tmp_path, content))


def test_unknown_key_is_refused_by_name(tmp_path):
    content = packaged_content()
    content["tracks"]["guage_m"] = 0.36
    with pytest.raises(CheckedFileError, match=r"tracks\.guage_m"):
        load_robot(write(tmp_path, content))


def test_missing_key_is_named(tmp_path):
    content = packaged_content()
    del content["control"]["transport_delay_s"]
    with pytest.raises(CheckedFileError, match=r"control\.transport_delay_s"):
        load_robot(write(tmp_path, content))


@pytest.mark.parametrize("text", ["", "- 1\n- 2\n", "a: [1,", "\x00"])
def test_content_that_is_no_robot_is_refused(tmp_path, text):
    path = tmp_path / "robot.yaml"
    path.write_text(text)
    with pytest.raises(CheckedFileError, match=r"robot\.yaml"):
        load_robot(path)


def test_missing_file_is_named():
    with pytest.raises(CheckedFileError, match="nowhere"):
        load_robot("nowhere.yaml")
