"""Slip with a third witness, simulated: dead reckoning without a lidar, slip with one, and tracks that turn in vain.

Prints tables and writes out/slip_witness/metrics.json. Reported seeds are below 1000; settings were tuned on others.
--quick takes fewer drives and says so.
"""

import argparse
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sim_bridge.simulator import Simulator
from sim_bridge.solids import Friction, Solid
from tracked_description import Robot, load_robot
from tracked_lab.witness.dead_reckoning import Drift, drifts
from tracked_lab.witness.drives import ROOMS_ROUTE, along_route, constant, on_belts, on_changing_ground
from tracked_lab.witness.witness_track import Columns, WitnessTrack
from tracked_report.results import write_metrics
from tracked_report.terminal import render_table

SEED = 11
_LEAST_STEP = 0.1  # changes of the ground smaller than this are no steps to settle from
_SETTLED = 0.1  # of the step
_RESPONSE_S = np.arange(0.0, 1.0, 1.0 / 60.0)

Array = NDArray[np.float64]


def rms(values: Array) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def away_from(changes: list[tuple[float, float, float]], times: Array, values: Array, seconds: float) -> Array:
    """``values`` that are not within ``seconds`` after a change of the ground."""
    kept = np.ones(len(times), bool)
    for change in changes:
        kept &= (times < change[0]) | (times > change[0] + seconds)
    return values[kept]


def settled_after(responses: list[Array]) -> float:
    """When the mean step response, the error as a share of the step, is within a tenth for good (s)."""
    beyond = np.flatnonzero(np.abs(np.mean(responses, axis=0)) > _SETTLED)
    return float(_RESPONSE_S[beyond[-1]] + 1.0 / 60.0) if len(beyond) else 0.0


def slip_with_lidar(robot: Robot, runs: int, seconds: float) -> dict[str, float]:
    """Slip on ground that changes every three seconds, and in the rooms on belts."""
    share, share_all, yaw, yaw_all = [], [], [], []
    share_steps, yaw_steps, scan_ms = [], [], []
    for seed in range(SEED, SEED + runs):
        track, changes = on_changing_ground(robot, seed, seconds)
        columns = track.columns()
        scan_ms += track.scan_s
        times, errors = columns.share_errors()
        share_all.append(errors)
        share.append(away_from(changes, times, errors, 0.5))
        for at_s, step, _ in changes[:-1]:
            if abs(step) > _LEAST_STEP:
                share_steps.append(np.interp(at_s + _RESPONSE_S, times, errors) / step)
        times, errors = columns.yaw_errors()
        yaw_all.append(errors)
        yaw.append(away_from(changes, times, errors, 0.3))
        yaw_steps += _yaw_responses(columns, changes)
    belts_share, belts_yaw = [], []
    for seed in range(SEED, SEED + max(1, runs // 2)):
        track = on_belts(robot, seed, 55.0, along_route(ROOMS_ROUTE))
        columns = track.columns()
        scan_ms += track.scan_s
        belts_share.append(columns.share_errors()[1])
        belts_yaw.append(columns.yaw_errors()[1])
    return {
        "slip.share_rms": rms(np.concatenate(share)),
        "slip.share_rms_with_changes": rms(np.concatenate(share_all)),
        "slip.share_settled_s": settled_after(share_steps),
        "slip.yaw_rms": rms(np.concatenate(yaw)),
        "slip.yaw_rms_with_changes": rms(np.concatenate(yaw_all)),
        "slip.yaw_settled_s": settled_after(yaw_steps),
        "slip.belts_share_rms": rms(np.concatenate(belts_share)),
        "slip.belts_yaw_rms": rms(np.concatenate(belts_yaw)),
        "slip.steps": float(len(share_steps)),
        "scan_ms": 1e3 * float(np.median(scan_ms)),
        "scan_p99_ms": 1e3 * float(np.percentile(scan_ms, 99)),
    }


def _yaw_responses(columns: Columns, changes: list[tuple[float, float, float]]) -> list[Array]:
    """Errors of the yaw slip after each change, as shares of the step that the truth made."""
    ratio = columns.true_yaw_slip / np.where(np.abs(columns.belt_radps) > 0.3, columns.belt_radps, np.nan)
    times, errors = columns.yaw_errors()
    responses = []
    for at_s, _, step in changes[:-1]:
        around = [(columns.time_s > at_s + edge) & (columns.time_s < at_s + edge + 0.3) for edge in (-0.4, 0.1)]
        change = float(np.nanmean(ratio[around[1]]) - np.nanmean(ratio[around[0]]))
        if abs(step) > _LEAST_STEP and abs(change) > _LEAST_STEP:
            responses.append(np.interp(at_s + _RESPONSE_S, times, errors) / change)
    return responses


def wedged(simulator: Simulator, now_s: float) -> None:
    """Walls along both tracks."""
    if now_s == 0.0:
        for name, side_m in (("left", 0.26), ("right", -0.26)):
            at = (simulator.start.x_m, simulator.start.y_m + side_m, 0.3)
            simulator.vehicle.entities.spawn(Solid(name, "box", (0.8, 0.04, 0.6), at))


def bottomless(simulator: Simulator, now_s: float) -> None:
    """Ground that gives no hold."""
    if now_s == 0.0:
        simulator.vehicle.set_friction(Friction(longitudinal=0.01, lateral=0.01))


def held_drives(robot: Robot) -> dict[str, Callable[[int, bool], WitnessTrack]]:
    """Drives in which the tracks turn and the robot does not."""
    return {
        "wall ahead": lambda seed, lidar: on_belts(
            robot, seed, 5.0, constant(0.4, 0.0), start=(6.8, 2.0, 0.0), lidar=lidar
        ),
        "wall behind": lambda seed, lidar: on_belts(
            robot, seed, 5.0, constant(-0.35, 0.0), start=(0.8, 1.2, 0.0), lidar=lidar
        ),
        "held at a wall": lambda seed, lidar: on_belts(
            robot, seed, 4.0, constant(0.3, 0.0), start=(7.69, 2.0, 0.0), lidar=lidar
        ),
        "wedged": lambda seed, lidar: on_belts(
            robot, seed, 4.0, constant(0.0, 1.0), start=(2.0, 1.5, 0.0), event=wedged, lidar=lidar
        ),
        "no hold": lambda seed, lidar: on_belts(
            robot, seed, 4.0, constant(0.4, 0.0), start=(2.0, 1.5, 0.0), event=bottomless, lidar=lidar
        ),
    }


def blocked(robot: Robot, runs: int) -> dict[str, float]:
    """Time to the alarm, and alarms where none is due."""
    rows, slowest, blind, false_alarms = [], 0.0, 0.0, 0
    for name, drive in held_drives(robot).items():
        seen, felt = [], []
        for seed in range(SEED, SEED + runs):
            for lidar, found in ((True, seen), (False, felt)):
                columns = drive(seed, lidar).columns()
                found.append(columns.detected_after_s())
                false_alarms += columns.false_alarms()
        slowest, blind = max(slowest, *seen), max(blind, *felt)
        rows.append([name, f"{max(seen):.2f}", f"{max(felt):.2f}"])
    print(render_table(rows, ["blocked, slowest alarm (s)", "all", "no lidar"], ["left", "right", "right"]))
    free = 0.0
    for seed in range(SEED, SEED + runs):
        for lidar in (True, False) if runs > 1 else (True,):
            drives = [on_belts(robot, seed, 55.0, along_route(ROOMS_ROUTE), lidar=lidar)]
            for world in ("ice", "step", "ramp", "slats", "corridor"):
                drives.append(on_belts(robot, seed, 12.0, constant(0.4, 0.0), world=world, lidar=lidar))
                drives.append(on_belts(robot, seed, 3.5, constant(0.3, 0.8), world=world, lidar=lidar))
            for track in drives:
                columns = track.columns()
                free += float(columns.time_s[-1])
                false_alarms += columns.false_alarms()
    print(f"alarms without cause: {false_alarms}, in the drives above and {free:.0f} s of free driving")
    return {
        "blocked.slowest_s": slowest,
        "blocked.slowest_without_lidar_s": blind,
        "blocked.false_alarms": float(false_alarms),
        "blocked.free_s": free,
    }


def dead_reckoning(robot: Robot, runs: int) -> dict[str, float]:
    """Drift over 40 m without a lidar."""
    values = {}
    for plant in ("belts", "kinematic"):
        found: dict[str, Drift] = drifts(robot, plant, range(SEED, SEED + runs))
        rows = [
            [name, f"{1e3 * drift.heading_rad:.1f}", f"{drift.position_m:.3f}", f"{drift.end_m:.3f}"]
            for name, drift in found.items()
        ]
        header = [f"40 m on {plant}, RMS", "heading (mrad)", "position (m)", "end (m)"]
        print(render_table(rows, header, ["left", "right", "right", "right"]))
        ours, encoders = found["filter with slip states"], found["encoders, best multiplier"]
        gyro, plain = found["gyro, bias of the first rest"], found["gyro and belt speed"]
        values |= {
            f"reckoning.{plant}.heading_gain": encoders.heading_rad / ours.heading_rad,
            f"reckoning.{plant}.heading_against_gyro": ours.heading_rad / gyro.heading_rad,
            f"reckoning.{plant}.position_gain": 1.0 - ours.position_m / plain.position_m,
        }
        for name, drift in found.items():
            key = name.replace(",", "").replace(" ", "_")
            values[f"reckoning.{plant}.{key}.heading_mrad"] = 1e3 * drift.heading_rad
            values[f"reckoning.{plant}.{key}.position_m"] = drift.position_m
    return values


def main() -> None:
    """Measure, print, write out/slip_witness/metrics.json."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--quick", action="store_true", help="one drive of each kind")
    quick = parser.parse_args().quick
    robot = load_robot()
    values = slip_with_lidar(robot, 1 if quick else 6, 30.0 if quick else 60.0)
    rows = [[name, f"{value:.4g}"] for name, value in values.items()]
    print(render_table(rows, ["slip with lidar", "measured"], ["left", "right"]))
    values |= blocked(robot, 1 if quick else 4)
    values |= dead_reckoning(robot, 1 if quick else 10)
    if quick:
        print("quick: fewer drives than the claims are measured on")
    write_metrics("slip_witness", {f"slip_witness.{key}": value for key, value in values.items()}, seed=SEED)


if __name__ == "__main__":
    main()
