"""Trajectories from CSV and YAML files.

CSV: a header ``time_s,x_m,y_m,yaw_rad`` with optional ``speed_mps,yaw_rate_radps``, then one point per
line; ``#`` starts a comment. YAML: ``points``, a list of mappings with the same keys. Inputs that a file
leaves out are derived from its poses, with zero at both ends.
"""

import csv
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray

from tracked_navigation.motion_limits import MotionLimits, find_violation
from tracked_types import Trajectory, angle_difference, wrap_angle

Array = NDArray[np.float64]
POSE_KEYS = ("time_s", "x_m", "y_m", "yaw_rad")
INPUT_KEYS = ("speed_mps", "yaw_rate_radps")
_LARGEST_FILE_BYTES = 20_000_000
_LARGEST_VALUE = 1e6
_SIDEWAYS_SHARE = 0.2  # of the distance between two points may be sideways
_SIDEWAYS_FLOOR_M = 0.01  # rounding of a file is no sideways motion
_REST_SPEED_MPS = 0.02
_REST_YAW_RATE_RADPS = 0.05


class TrajectoryFileError(ValueError):
    """A trajectory file cannot be used; the text names the file, the line or key, and the reason."""


@dataclass(frozen=True, slots=True)
class _Row:
    place: str  # how errors call it: "line 4" or "points[2]"
    values: dict[str, Any]


def load_trajectory(path: Path, limits: MotionLimits) -> Trajectory:
    """Read ``path``; the result has stamp 0, no frame, and its first point at time 0.

    Raises
    ------
    TrajectoryFileError: if the file is missing or malformed, a value is missing, not finite or beyond
        1e6, times do not increase, points move sideways, ends are not at rest, or it exceeds ``limits``.
    """
    try:
        if path.stat().st_size > _LARGEST_FILE_BYTES:
            raise TrajectoryFileError(f"{path}: larger than {_LARGEST_FILE_BYTES // 1_000_000} MB")
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise TrajectoryFileError(f"{path}: cannot be read ({error.strerror})") from error
    except UnicodeDecodeError as error:
        raise TrajectoryFileError(f"{path}: is not a text file") from error
    try:
        rows = list(_yaml_rows(text) if path.suffix.lower() in {".yaml", ".yml"} else _csv_rows(text))
        return _trajectory(rows, limits)
    except _Problem as problem:
        raise TrajectoryFileError(f"{path}: {problem}") from problem


class _Problem(Exception):
    """A reason to refuse the file, without its name."""


def _csv_rows(text: str) -> Iterator[_Row]:
    header: list[str] | None = None
    for number, line in enumerate(text.splitlines(), start=1):
        content = line.split("#", 1)[0].strip()
        if not content:
            continue
        cells = [cell.strip() for cell in next(csv.reader([content]))]
        if header is None:
            header = cells
            _check_keys(set(header), f"line {number}: the header")
            if len(set(header)) != len(header):
                raise _Problem(f"line {number}: the header names a column twice")
        elif len(cells) != len(header):
            raise _Problem(f"line {number}: expected {len(header)} values, found {len(cells)}")
        else:
            yield _Row(f"line {number}", dict(zip(header, cells, strict=True)))


def _yaml_rows(text: str) -> Iterator[_Row]:
    try:
        content = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise _Problem(f"is not a YAML file ({error})") from error
    points = content.get("points") if isinstance(content, dict) else None
    if not isinstance(points, list):
        raise _Problem("points: expected a list of mappings")
    for index, point in enumerate(points):
        if not isinstance(point, dict):
            raise _Problem(f"points[{index}]: expected a mapping, got {point!r:.60}")
        _check_keys({str(key) for key in point}, f"points[{index}]")
        yield _Row(f"points[{index}]", point)


def _check_keys(found: set[str], place: str) -> None:
    missing = [key for key in POSE_KEYS if key not in found]
    unknown = sorted(found - set(POSE_KEYS) - set(INPUT_KEYS))
    if missing:
        raise _Problem(f"{place} lacks {', '.join(missing)}")
    if unknown:
        raise _Problem(f"{place} has unknown key {unknown[0]!r}; known are {', '.join(POSE_KEYS + INPUT_KEYS)}")
    if len(found & set(INPUT_KEYS)) == 1:
        raise _Problem(f"{place} needs both of {', '.join(INPUT_KEYS)} or neither")


def _number(row: _Row, key: str) -> float:
    raw = row.values.get(key)
    try:
        if isinstance(raw, bool) or raw is None:
            raise TypeError
        value = float(raw)
    except (TypeError, ValueError):
        raise _Problem(f"{row.place}: {key} must be a number, got {raw!r:.40}") from None
    if not abs(value) <= _LARGEST_VALUE:
        raise _Problem(f"{row.place}: {key} must be finite and at most {_LARGEST_VALUE:g}, got {raw!r:.40}")
    return value


def _trajectory(rows: list[_Row], limits: MotionLimits) -> Trajectory:
    if len(rows) < 2:
        raise _Problem(f"needs at least two points, found {len(rows)}")
    poses = np.array([[_number(row, key) for key in POSE_KEYS] for row in rows])
    times = poses[:, 0]
    for index in np.flatnonzero(np.diff(times) <= 0.0)[:1] + 1:
        what = "repeats" if times[index] == times[index - 1] else "is before"
        raise _Problem(f"{rows[index].place}: time_s {times[index]:g} {what} that of {rows[index - 1].place}")
    states = np.column_stack((poses[:, 1:3], wrap_angle(poses[:, 3])))
    forward, turn = _displacements(states, rows)
    if INPUT_KEYS[0] in rows[0].values:
        inputs = np.array([[_number(row, key) for key in INPUT_KEYS] for row in rows])
    else:
        inputs = _derived_inputs(times, forward, turn)
    trajectory = Trajectory(0, "", times - times[0], states, inputs)
    _check_driveable(trajectory, _mean_inputs(times, forward, turn), limits, rows)
    return trajectory


def _displacements(states: Array, rows: list[_Row]) -> tuple[Array, Array]:
    """Signed forward distance (m) and turn (rad) between neighbours; a sideways step is refused."""
    step = np.diff(states[:, :2], axis=0)
    turn = angle_difference(states[1:, 2], states[:-1, 2])
    middle = states[:-1, 2] + 0.5 * turn
    forward = np.cos(middle) * step[:, 0] + np.sin(middle) * step[:, 1]
    sideways = np.abs(np.cos(middle) * step[:, 1] - np.sin(middle) * step[:, 0])
    for index in np.flatnonzero(sideways > _SIDEWAYS_FLOOR_M + _SIDEWAYS_SHARE * np.abs(forward))[:1]:
        raise _Problem(f"{rows[index + 1].place}: moves {sideways[index]:.3g} m sideways, which tracks cannot")
    return forward, turn


def _mean_inputs(times: Array, forward: Array, turn: Array) -> Array:
    return np.stack((forward, turn), 1) / np.diff(times)[:, None]


def _derived_inputs(times: Array, forward: Array, turn: Array) -> Array:
    """Means over both neighbouring steps, zero at the ends: (n, 2)."""
    travelled = np.stack((forward, turn), 1)
    inner = (travelled[1:] + travelled[:-1]) / (times[2:] - times[:-2])[:, None]
    return np.concatenate((np.zeros((1, 2)), inner, np.zeros((1, 2))))


def _check_driveable(trajectory: Trajectory, means: Array, limits: MotionLimits, rows: list[_Row]) -> None:
    for index in (0, -1):
        speed, yaw_rate = (abs(float(value)) for value in trajectory.inputs[index])
        if speed > _REST_SPEED_MPS or yaw_rate > _REST_YAW_RATE_RADPS:
            raise _Problem(f"{rows[index].place}: must be at rest, moves with {speed:.3g} m/s and {yaw_rate:.3g} rad/s")
    # What the poses ask counts as well as what the inputs say, or inputs could hide a jump.
    for index, (speed, yaw_rate) in enumerate(means):
        track = abs(speed) + limits.half_gauge_m * abs(yaw_rate)
        place = rows[index + 1].place
        if not limits.speed_min_mps <= speed <= limits.speed_max_mps:
            raise _Problem(f"{place}: too fast, {speed:.3g} m/s from {rows[index].place}")
        if abs(yaw_rate) > limits.yaw_rate_radps or track > limits.track_speed_mps:
            raise _Problem(f"{place}: turns too fast, {yaw_rate:.3g} rad/s from {rows[index].place}")
    violation = find_violation(trajectory, limits)
    if violation:
        raise _Problem(f"{rows[violation.index].place}: {violation.reason}")
