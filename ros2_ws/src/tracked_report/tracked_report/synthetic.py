"""Made-up records, for tests and for working on the report's looks without a simulator.

Nothing here is a result: the errors are drawn, not driven.
"""

from dataclasses import dataclass

import numpy as np

from tracked_report.channel import Array
from tracked_report.machine import describe_machine, package_versions
from tracked_report.run_record import CommandLimits, RunMeta, RunRecord
from tracked_report.run_recorder import RunRecorder
from tracked_types import NANOSECONDS_PER_SECOND, Outline, PeriodGrid, Trajectory, wrap_angle

_SPEED_MPS = 0.3
_STEP_X_M = (2.0, 2.6)


@dataclass(frozen=True, slots=True)
class SyntheticSettings:
    """``layers`` decides the size of the errors; ``truth`` and ``arrivals`` what is recorded at all."""

    layers: str = "double"
    seed: int = 1
    duration_s: float = 22.0
    truth: bool = True
    arrivals: bool = True


def synthetic_record(settings: SyntheticSettings | None = None) -> RunRecord:
    """A run along an S-curve over a step; the same settings give the same record."""
    chosen = settings or SyntheticSettings()
    random = np.random.default_rng([chosen.seed, int(chosen.layers == "single")])
    recorder = RunRecorder()
    grid = PeriodGrid(60)
    stamps = [grid.stamp_ns(index) for index in range(60, 60 + int(chosen.duration_s * 60))]
    times = np.array(stamps) / NANOSECONDS_PER_SECOND - 1.0
    reference, yaw_rate = _reference(times, chosen.duration_s - 3.0)
    size = 0.045 if chosen.layers == "single" else 0.018
    error = size * np.column_stack([_wander(times, random), _wander(times, random), 1.6 * _wander(times, random)])
    drift = np.outer(times / chosen.duration_s, [0.02, -0.03, 0.01])
    moving = (times < chosen.duration_s - 3.0).astype(float)
    slip = np.column_stack([-0.01 * moving + 0.003 * random.normal(size=times.size), -0.22 * yaw_rate])
    inside = (reference[:, 0] > _STEP_X_M[0]) & (reference[:, 0] < _STEP_X_M[1])
    bump = np.where(inside, 2.2, 0.15) * random.normal(size=times.size) * moving
    for index, stamp in enumerate(stamps):
        arrival = 100.0 + times[index] / 1.4 + 0.0004 * random.exponential() if chosen.arrivals else np.nan
        pose = reference[index] - error[index]
        twist = (_SPEED_MPS * moving[index], yaw_rate[index])
        recorder.add_row("odometry", stamp, (*pose, *twist, 1e-4, 1e-4, 1e-5), arrival_s=arrival)
        known = moving[index]
        noisy = slip[index] + known * random.normal(size=2) * (0.004, 0.012)
        recorder.add_row("slip", stamp, (*noisy, 1e-5, 1e-4, known), arrival_s=arrival)
        if chosen.truth:
            x, y, yaw = pose + drift[index]
            z = 0.02 * float(inside[index])
            recorder.add_row("truth", stamp, (x, y, z, 0.0, -z, yaw, *twist[:1], 0.0, twist[1]), arrival_s=arrival)
            recorder.add_row("truth_slip", stamp, (*slip[index], 0.0, 0.0, known), arrival_s=arrival)
            recorder.add_row("acceleration", stamp, (bump[index],), arrival_s=arrival)
        if index % 12 == 0:
            _plan(recorder, stamps[index:], times[index:], reference[index:], yaw_rate[index:], arrival)
            recorder.add_row("upper_status", stamp, (1.0, 4.0, 2.0, 9e-5 * random.gamma(9.0) / 9.0), arrival_s=arrival)
        if index % 2 == 0:
            late = arrival + 0.003 + 0.002 * random.exponential()
            if chosen.layers == "double":
                row = (1.0, 3.0, 1.0, 1e-4 * random.gamma(7.0) / 7.0)
                recorder.add_row("lower_status", stamp, row, arrival_s=late)
            command = (twist[0] + 0.02 * random.normal() * known, twist[1] * 1.2 + 0.05 * random.normal() * known)
            recorder.add_row("cmd_vel", stamp, command, arrival_s=late)
    recorder.add_event(stamps[-1], "trajectory_player", "goal reached, 0.012 m and 0.010 rad off")
    return recorder.record(_meta(chosen))


def synthetic_pair(seed: int = 1, duration_s: float = 22.0) -> dict[str, RunRecord]:
    """A single-layer and a double-layer record, as the demo's."""
    settings = [SyntheticSettings(layers=layers, seed=seed, duration_s=duration_s) for layers in ("single", "double")]
    return {chosen.layers: synthetic_record(chosen) for chosen in settings}


def _reference(times: Array, rest_s: float) -> tuple[Array, Array]:
    """Poses (n, 3) and yaw rates (n,) of an S-curve driven at constant speed along x."""
    moving = np.minimum(times, rest_s)
    phase = 2.0 * np.pi * moving / rest_s
    x, y = _SPEED_MPS * moving, 0.5 * (1.0 - np.cos(phase))
    slope = 0.5 * np.sin(phase) * 2.0 * np.pi / (rest_s * _SPEED_MPS)
    yaw = np.arctan(slope)
    rate = np.where(times < rest_s, np.gradient(yaw, times), 0.0)
    return np.column_stack([x, y, wrap_angle(yaw)]), rate


def _wander(times: Array, random: np.random.Generator) -> Array:
    """A smooth signal of about unit size (n,)."""
    total = np.zeros_like(times)
    for frequency in (0.07, 0.19, 0.43, 1.1):
        total += random.normal() * np.sin(2.0 * np.pi * (frequency * times + random.uniform()))
    return np.asarray(total / 1.4)


def _plan(
    recorder: RunRecorder, stamps: list[int], times: Array, poses: Array, yaw_rate: Array, arrival_s: float
) -> None:
    count = min(len(stamps), 121)
    inputs = np.column_stack([np.full(count, _SPEED_MPS), yaw_rate[:count]])
    plan = Trajectory(stamps[0], "odom", times[:count] - times[0], poses[:count], inputs)
    recorder.add("reference", plan, arrival_s)
    recorder.add("upper_plan", plan, arrival_s)


def _meta(settings: SyntheticSettings) -> RunMeta:
    step = Outline.box(sum(_STEP_X_M) / 2, 0.5, _STEP_X_M[1] - _STEP_X_M[0], 2.4, kind="step", label="step 40 mm")
    return RunMeta(
        scenario="synthetic",
        variant=settings.layers,
        description="Made-up data: the looks of the report, not a result.",
        seed=settings.seed,
        world="step",
        time="lock_step",
        suspension="qzs",
        pipeline_latency_s=0.1,
        wall_duration_s=settings.duration_s / 1.4,
        limits=CommandLimits(speed_min_mps=-0.4, speed_max_mps=0.5, yaw_rate_max_radps=1.3),
        scene=(
            step,
            Outline.box(2.7, 2.0, 6.6, 0.06, kind="wall"),
            Outline.circle(4.6, -0.2, 0.2, kind="obstacle", label="post"),
            Outline.box(4.2, 0.9, 0.9, 0.8, kind="friction", label="ice", yaw_rad=0.3),
        ),
        machine=describe_machine(),
        versions=package_versions(),
    )
