import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from tracked_localization.mapping.map_files import MapFileError, load_map, save_map
from tracked_types import OccupancyMap, Pose2
from tracked_types.checked_yaml import CheckedFileError

GREYS = np.array([[0, 100, 205], [230, 254, 255]], np.uint8)  # of the picture, upper row first


def map_yaml(folder, text="", image="room.png", **changes):
    if image == "room.png":
        cv2.imwrite(str(folder / image), GREYS)
    keys = {"image": image, "resolution": 0.1, "origin": [1.0, 2.0, 0.5], "negate": 0} | changes
    file = folder / "room.yaml"
    file.write_text("\n".join(f"{key}: {value}" for key, value in keys.items()) + text)
    return file


@settings(max_examples=30, deadline=None)
@given(
    occupancy=hnp.arrays(
        np.int8, st.tuples(st.integers(1, 20), st.integers(1, 20)), elements=st.sampled_from([-1, 0, 100])
    ),
    x_m=st.floats(-1e3, 1e3),
    yaw_rad=st.floats(-3.0, 3.0),
)
def test_a_saved_map_loads_as_it_was(tmp_path_factory, occupancy, x_m, yaw_rad):
    before = OccupancyMap("map", 0.05, Pose2(x_m, -1.5, yaw_rad), occupancy)
    after = load_map(save_map(before, tmp_path_factory.mktemp("maps") / "a.b"), "map")
    assert np.array_equal(after.occupancy, before.occupancy)
    assert after.origin == before.origin and after.resolution_m == before.resolution_m


def test_a_saved_map_looks_as_map_server_wants_it(tmp_path):
    occupancy = np.array([[0, 100], [-1, 30]], np.int8)
    save_map(OccupancyMap("map", 0.05, Pose2(0.0, 0.0, 0.0), occupancy), tmp_path / "room")
    assert (tmp_path / "room.pgm").read_bytes() == b"P5\n# 0.050000 m/pix\n2 2\n255\n" + bytes([205, 205, 254, 0])


@pytest.mark.parametrize(
    ("mode", "negate", "expected"),
    [
        ("trinary", 0, [[0, 0, 0], [100, -1, -1]]),
        ("trinary", 1, [[100, 100, 100], [0, -1, 100]]),
        ("scale", 0, [[0, 0, 0], [100, 91, 0]]),
        ("raw", 0, [[-1, -1, -1], [0, 100, -1]]),
    ],
)
def test_maps_from_elsewhere_load_in_every_mode(tmp_path, mode, negate, expected):
    loaded = load_map(map_yaml(tmp_path, mode=mode, negate=negate), "map")
    assert loaded.occupancy.tolist() == expected


def test_what_is_transparent_is_unknown_on_a_scaled_map(tmp_path):
    picture = np.dstack([np.full((2, 2, 3), 150, np.uint8), np.array([[0, 255], [255, 255]], np.uint8)])
    cv2.imwrite(str(tmp_path / "see.png"), picture)
    loaded = load_map(map_yaml(tmp_path, image="see.png", mode="scale"), "map")
    assert loaded.occupancy[1, 0] == -1 and loaded.occupancy[1, 1] > 0


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"resolution": -0.05}, "resolution"),
        ({"resolution": ".nan"}, "resolution"),
        ({"origin": [0.0, ".inf", 0.0]}, "origin"),
        ({"origin": [0.0, 0.0]}, "origin"),
        ({"mode": "fourfold"}, "mode"),
        ({"free_thresh": 0.7}, "free_thresh"),
        ({"image": "gone.pgm"}, "gone.pgm"),
        ({"image": "room.yaml"}, "picture"),
    ],
)
def test_a_map_that_cannot_be_used_is_refused_by_name(tmp_path, changes, word):
    with pytest.raises(CheckedFileError, match=word):
        load_map(map_yaml(tmp_path, **changes), "map")


def test_a_picture_cut_short_or_of_endless_size_is_refused(tmp_path):
    (tmp_path / "cut.pgm").write_bytes(b"P5\n4000000000 4000000000\n255\n123")
    with pytest.raises(MapFileError, match=r"cut\.pgm"):
        load_map(map_yaml(tmp_path, image="cut.pgm"), "map")


def test_a_map_that_cannot_be_written_says_where(tmp_path):
    room = OccupancyMap("map", 0.05, Pose2(0.0, 0.0, 0.0), np.zeros((2, 2), np.int8))
    with pytest.raises(MapFileError, match="cannot be written"):
        save_map(room, tmp_path / "nowhere" / "room")
