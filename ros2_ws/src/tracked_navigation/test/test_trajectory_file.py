from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from tracked_description import load_robot
from tracked_navigation import MotionLimits, ReferenceSettings, make_reference
from tracked_navigation.shape_settings import ShapeSettings
from tracked_navigation.shapes import build_shape
from tracked_navigation.trajectory_file import TrajectoryFileError, load_trajectory

LIMITS = MotionLimits.from_robot(load_robot())
HEADER = "time_s,x_m,y_m,yaw_rad"
GOOD = [HEADER, "0,0,0,0", "0.5,0.05,0,0", "1.0,0.2,0,0", "1.5,0.35,0,0", "2.0,0.4,0,0"]


def write(folder: Path, text: str, name: str = "path.csv") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def replaced(line: int, text: str) -> str:
    lines = list(GOOD)
    lines[line - 1] = text
    return "\n".join(lines)


def test_poses_alone_give_speeds_and_rest_at_the_ends(tmp_path: Path) -> None:
    trajectory = load_trajectory(write(tmp_path, "# a comment\n" + "\n".join(GOOD)), LIMITS)
    assert trajectory.inputs[:, 0] == pytest.approx([0.0, 0.2, 0.3, 0.2, 0.0])
    assert trajectory.inputs[:, 1] == pytest.approx(0.0)


def test_time_counts_from_the_first_point(tmp_path: Path) -> None:
    shifted = "\n".join([HEADER] + [f"{float(line.split(',')[0]) + 7},{line.split(',', 1)[1]}" for line in GOOD[1:]])
    assert load_trajectory(write(tmp_path, shifted), LIMITS).times_s[0] == 0.0


@pytest.mark.parametrize("suffix", ["csv", "yaml"])
def test_a_written_shape_reads_back(tmp_path: Path, suffix: str) -> None:
    shape = build_shape(ShapeSettings(shape="figure_eight"))
    keys = [*HEADER.split(","), "speed_mps", "yaw_rate_radps"]
    table = np.column_stack((shape.times_s, shape.states, shape.inputs))
    if suffix == "csv":
        text = "\n".join([",".join(keys), *(",".join(map(repr, row)) for row in table.tolist())])
    else:
        text = yaml.safe_dump({"points": [dict(zip(keys, row, strict=True)) for row in table.tolist()]})
    read = make_reference(
        load_robot(),
        ReferenceSettings(trajectory_file=str(write(tmp_path, text, f"eight.{suffix}"))),
        ShapeSettings(),
    )
    assert read.name == "eight"
    assert read.trajectory.states == pytest.approx(shape.states, abs=1e-9)
    assert read.trajectory.inputs == pytest.approx(shape.inputs, abs=1e-9)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "at least two points"),
        (HEADER, "at least two points"),
        ("time_s,x_m,y_m\n0,0,0", "line 1: the header lacks yaw_rad"),
        (replaced(1, HEADER + ",colour"), "line 1: the header has unknown key 'colour'"),
        (replaced(1, HEADER + ",speed_mps"), "line 1: the header needs both of speed_mps"),
        (replaced(1, HEADER + ",x_m"), "names a column twice"),
        (replaced(3, "0.5,0.05,0"), "line 3: expected 4 values, found 3"),
        (replaced(3, "0.5,abc,0,0"), "line 3: x_m must be a number, got 'abc'"),
        (replaced(3, "0.5,nan,0,0"), "line 3: x_m must be finite"),
        (replaced(3, "0.5,1e300,0,0"), "line 3: x_m must be finite"),
        (replaced(4, "0.5,0.2,0,0"), "line 4: time_s 0.5 repeats that of line 3"),
        (replaced(4, "0.4,0.2,0,0"), "line 4: time_s 0.4 is before that of line 3"),
        (replaced(4, "1.0,2.2,0,0"), "line 4: too fast"),
        (replaced(4, "1.0,0.2,0.3,0"), "line 4: moves .* sideways"),
        (replaced(2, "0,0.05,0,2.5"), "line 3: turns too fast"),
    ],
)
def test_a_csv_that_cannot_be_driven_is_refused_with_its_line(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(TrajectoryFileError, match=rf"path\.csv: .*{words}"):
        load_trajectory(write(tmp_path, text), LIMITS)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("points: 3", "points: expected a list"),
        ("[1, 2]", "points: expected a list"),
        ("points: [1]", r"points\[0\]: expected a mapping"),
        ("points: [{time_s: 0, x_m: 0, y_m: 0}]", r"points\[0\] lacks yaw_rad"),
        ("points: [{time_s: 0, x_m: true, y_m: 0, yaw_rad: 0}, {time_s: 1, x_m: 0, y_m: 0, yaw_rad: 0}]", "x_m must"),
        ("points: [", "is not a YAML file"),
    ],
)
def test_a_yaml_that_cannot_be_driven_is_refused_with_its_key(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(TrajectoryFileError, match=words):
        load_trajectory(write(tmp_path, text, "path.yaml"), LIMITS)


def test_yaml_points_that_mix_their_keys_are_refused(tmp_path: Path) -> None:
    full = {"time_s": 0.0, "x_m": 0.0, "y_m": 0.0, "yaw_rad": 0.0, "speed_mps": 0.0, "yaw_rate_radps": 0.0}
    text = yaml.safe_dump({"points": [full, {key: 1.0 if key == "time_s" else 0.0 for key in HEADER.split(",")}]})
    with pytest.raises(TrajectoryFileError, match=r"points\[1\]: speed_mps must be a number"):
        load_trajectory(write(tmp_path, text, "path.yaml"), LIMITS)


def test_a_file_that_ends_in_motion_is_refused(tmp_path: Path) -> None:
    text = f"{HEADER},speed_mps,yaw_rate_radps\n0,0,0,0,0,0\n1,0.1,0,0,0.2,0"
    with pytest.raises(TrajectoryFileError, match="line 3: must be at rest"):
        load_trajectory(write(tmp_path, text), LIMITS)


def test_inputs_that_jump_are_refused(tmp_path: Path) -> None:
    text = f"{HEADER},speed_mps,yaw_rate_radps\n0,0,0,0,0,0\n0.1,0.02,0,0,0.4,0\n0.2,0.04,0,0,0,0"
    with pytest.raises(TrajectoryFileError, match="line 3: needs an acceleration"):
        load_trajectory(write(tmp_path, text), LIMITS)


@pytest.mark.parametrize("name", ["missing.csv", "."])
def test_an_unreadable_file_is_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(TrajectoryFileError, match="cannot be read"):
        load_trajectory(tmp_path / name, LIMITS)


def test_binary_content_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "path.csv"
    path.write_bytes(b"\xff\xfe\x00\x81")
    with pytest.raises(TrajectoryFileError, match="not a text file"):
        load_trajectory(path, LIMITS)


@settings(deadline=None, max_examples=60)
@given(text=st.text(max_size=200), suffix=st.sampled_from(["csv", "yaml"]))
def test_arbitrary_text_is_refused_and_never_crashes(
    tmp_path_factory: pytest.TempPathFactory, text: str, suffix: str
) -> None:
    path = tmp_path_factory.mktemp("any") / f"path.{suffix}"
    path.write_bytes(text.encode("utf-8", errors="ignore"))
    with pytest.raises(TrajectoryFileError):
        load_trajectory(path, LIMITS)
