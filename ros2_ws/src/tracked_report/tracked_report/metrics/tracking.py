"""Tracking error, in the frame of the truth and in the frame of the estimate."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from tracked_report.channel import Array, Channel, Stamps
from tracked_report.metrics.settings import MetricSettings
from tracked_report.metrics.sheet import MetricSheet, NotRecordedError
from tracked_report.run_record import RunRecord
from tracked_report.signals import peak, peak_to_peak, root_mean_square
from tracked_types import Pose2, angle_difference, to_nanoseconds, wrap_angle

Frame = Literal["estimated", "true"]
FRAMES: tuple[Frame, ...] = ("estimated", "true")
AXES = (("x", "m"), ("y", "m"), ("theta", "rad"))
_AT_REST = 1e-9


@dataclass(frozen=True, slots=True)
class Tracking:
    """Poses and errors at the instants of the odometry or the truth; everything in the odom frame.

    stamps_ns: (n,); pose, reference, error: (n, 3) of x (m), y (m), theta (rad). error = reference - pose,
    theta wrapped. counted: (n,) the samples that (5.3.1) and (5.3.2) run over. rest_ns: when the reference
    comes to rest.
    """

    stamps_ns: Stamps
    pose: Array
    reference: Array
    error: Array
    counted: NDArray[np.bool_]
    rest_ns: int


def poses_in_world(record: RunRecord, name: str) -> Channel:
    """x_m, y_m, yaw_rad of a channel, clean and in the world frame (the truth is there already)."""
    channel = _poses(record.channel(name))
    return channel if name == "truth" else _moved(channel, record.meta.odom_pose)


def tracking(record: RunRecord, frame: Frame, settings: MetricSettings) -> Tracking:
    """Tracking error against the reference at the same stamps.

    Samples count from the first reference point until ``tail_s`` after the reference has come to rest.

    Raises
    ------
    NotRecordedError: if the reference, or the poses of this frame, were not recorded at the same time.
    """
    reference = _poses(record.channel("reference"))
    if not len(reference):
        raise NotRecordedError("no reference was recorded")
    source = "odometry" if frame == "estimated" else "truth"
    measured = _poses(record.channel(source))
    if frame == "true":
        measured = _moved(measured, record.meta.odom_pose.inverse())
    measured = measured.rows(np.asarray(measured.stamps_ns >= reference.stamps_ns[0]))
    if not len(measured):
        raise NotRecordedError(f"no {source} was recorded while there was a reference")
    wanted = reference.at(measured.stamps_ns)
    error = wanted - measured.values
    error[:, 2] = angle_difference(wanted[:, 2], measured.values[:, 2])
    rest_ns = _rest(reference)
    counted = np.asarray(measured.stamps_ns <= rest_ns + to_nanoseconds(settings.tail_s))
    return Tracking(measured.stamps_ns, measured.values, wanted, error, counted, rest_ns)


def tracking_metrics(record: RunRecord, frame: Frame, settings: MetricSettings) -> MetricSheet:
    """Figures of the tracking error, keys ``<kind>_<axis>_<unit>``: ptop (5.3.1), rms (5.3.2), max per axis;
    rms and max of the distance; recovery time after a sudden change of the pose, if there was one; settling time and
    what remains at the end; share of the reference's time for which there are samples at all."""
    sheet = MetricSheet()
    run = tracking(record, frame, settings)
    sheet.put("covered_percent", _covered_percent(run, int(record.channel("reference").clean().stamps_ns[0])))
    counted = run.error[run.counted]
    for index, (axis, unit) in enumerate(AXES):
        sheet.put(f"ptop_{axis}_{unit}", peak_to_peak(counted[:, index]))
        sheet.put(f"rms_{axis}_{unit}", root_mean_square(counted[:, index]))
        sheet.put(f"max_{axis}_{unit}", peak(counted[:, index]))
    distance = np.hypot(run.error[:, 0], run.error[:, 1])
    sheet.put("rms_distance_m", root_mean_square(distance[run.counted]))
    sheet.put("max_distance_m", peak(distance[run.counted]))
    if record.meta.disturbed_s is not None:
        end_ns = to_nanoseconds(record.meta.disturbed_s[1])
        sheet.put("recovery_s", _recovery_s(run, distance, end_ns, settings), "the robot did not recover")
    if run.stamps_ns[-1] < run.rest_ns:
        sheet.missing["final"] = "the record ends before the reference comes to rest"
        return sheet
    sheet.put("final_distance_m", float(distance[-1]))
    sheet.put("final_theta_rad", abs(float(run.error[-1, 2])))
    sheet.put("settling_s", _settling_s(run, distance, settings), "the robot did not settle at the end")
    return sheet


def _poses(channel: Channel) -> Channel:
    return channel.select(("x_m", "y_m", "yaw_rad")).clean()


def _moved(poses: Channel, frame: Pose2) -> Channel:
    """Poses given in ``frame``, expressed in its parent."""
    cosine, sine = math.cos(frame.yaw_rad), math.sin(frame.yaw_rad)
    x, y, yaw = poses.values.T
    moved = np.column_stack(
        [frame.x_m + cosine * x - sine * y, frame.y_m + sine * x + cosine * y, wrap_angle(yaw + frame.yaw_rad)]
    )
    return Channel(poses.columns, poses.stamps_ns, moved, poses.arrivals_s)


def _rest(reference: Channel) -> int:
    """Stamp from which on the reference stays at its last pose."""
    away = np.abs(reference.values - reference.values[-1])
    away[:, 2] = np.abs(wrap_angle(reference.values[:, 2] - reference.values[-1, 2]))
    moving = np.flatnonzero(away.max(axis=1) > _AT_REST)
    return int(reference.stamps_ns[moving[-1] + 1]) if len(moving) else int(reference.stamps_ns[0])


def _covered_percent(run: Tracking, start_ns: int) -> float:
    """Time between neighbouring samples, three typical steps at most, over the time the reference moves."""
    stamps = run.stamps_ns[run.stamps_ns <= run.rest_ns]
    if run.rest_ns <= start_ns or len(stamps) < 2:
        return 100.0 if len(stamps) else 0.0
    steps = np.diff(np.concatenate([[start_ns], stamps, [run.rest_ns]])).astype(np.float64)
    longest = 3.0 * float(np.median(steps[1:-1]))
    return 100.0 * float(steps[steps <= longest].sum()) / float(run.rest_ns - start_ns)


def _settling_s(run: Tracking, distance: Array, settings: MetricSettings) -> float:
    """Time from the reference's rest until the errors stay within the bounds; NaN if they do not."""
    outside = (distance > settings.settled_position_m) | (np.abs(run.error[:, 2]) > settings.settled_yaw_rad)
    if outside[-1]:
        return math.nan
    last = np.flatnonzero(outside)
    settled_ns = run.stamps_ns[last[-1] + 1] if len(last) else run.stamps_ns[0]
    return max(0.0, float(settled_ns - run.rest_ns) * 1e-9)


def _recovery_s(run: Tracking, distance: Array, end_ns: int, settings: MetricSettings) -> float:
    """Time from the end of a disturbance until the errors are within the bounds and stay there for the time to hold.

    NaN if they never do.
    """
    inside = (distance <= settings.recovered_position_m) & (np.abs(run.error[:, 2]) <= settings.recovered_yaw_rad)
    after = run.stamps_ns >= end_ns
    stamps, inside = run.stamps_ns[after], inside[after]
    if not len(stamps):
        return math.nan
    hold_ns = to_nanoseconds(settings.recovered_hold_s)
    # Every stretch within the bounds begins at the disturbance's end or right after a sample outside them.
    outside = stamps[~inside]
    begins = np.concatenate([[-1], np.flatnonzero(~inside)]) + 1
    ends = np.append(outside, stamps[-1:])
    for begin, stretch_end in zip(begins.tolist(), ends.tolist(), strict=True):
        if begin < len(stamps) and stretch_end - stamps[begin] >= hold_ns:
            return float(stamps[begin] - end_ns) * 1e-9
    return math.nan
