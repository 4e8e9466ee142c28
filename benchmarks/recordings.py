"""Real recordings: slip law and odometry filter on skid-steer vehicles they were not made for.

Prints a table, writes out/recordings/metrics.json and out/recordings/index.html. Exit code 1 if a target is missed.
"""

import argparse
import sys

import numpy as np

from tracked_lab.recordings import (
    TARGETS,
    FilterRun,
    GpsComparison,
    Method,
    OutdoorDrive,
    compare,
    compare_with_gps,
    load_drive_windows,
    load_outdoor_drive,
    load_vehicle,
    run_filter,
    wheels_alone,
    wheels_and_gyro,
)
from tracked_lab.recordings.recordings_page import recordings_page
from tracked_report.machine import git_commit
from tracked_report.results import output_folder, write_metrics
from tracked_report.terminal import coloured, render_table
from tracked_report.whole_file import write_whole

SEED = 41
_SWAY_S = 1.0
"""A vehicle that has just stopped still sways; the mean reading at rest leaves this out at both ends."""


def slip_values(methods: list[Method]) -> dict[str, float]:
    values = {}
    for method in methods:
        low, high = method.interval_m(SEED)
        figures = {"rms_m": method.rms_m, "rms_low_m": low, "rms_high_m": high, "median_m": method.median_m}
        values |= {f"recordings.slip.{method.key}.{name}": figure for name, figure in figures.items()}
    return values


def outdoor_values(drive: OutdoorDrive, run: FilterRun, compared: dict[str, GpsComparison]) -> dict[str, float]:
    values = {}
    for name, comparison in compared.items():
        key = f"recordings.outdoor.{name.replace(' ', '_')}"
        values |= {f"{key}.mean_m": comparison.mean_m, f"{key}.end_m": comparison.end_m}
    begin_s, end_s = max(run.rests_s, key=lambda rest: rest[1] - rest[0])
    resting = (drive.imu_s > begin_s + _SWAY_S) & (drive.imu_s < end_s - _SWAY_S)
    at_rest, learnt = float(np.mean(drive.gyro_radps[resting, 2])), run.bias_at(end_s - _SWAY_S)
    return values | {
        "recordings.outdoor.longest_deaf_s": max(run.longest_deaf_s.values()),
        "recordings.outdoor.refused": float(sum(run.offences.values())),
        "recordings.outdoor.imu.nis": run.nis["imu"],
        "recordings.outdoor.tracks.nis": run.nis["tracks"],
        "recordings.outdoor.gyro_at_rest_radps": at_rest,
        "recordings.outdoor.bias_radps": learnt,
        "recordings.outdoor.bias_error_radps": abs(learnt - at_rest),
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="the same: everything is measured in seconds")
    parser.parse_args()
    slipping, outdoors = load_vehicle("norlab_husky"), load_vehicle("husky_outdoor")
    windows = load_drive_windows(slipping.as_robot().tracks.wheel_radius_m)
    methods = compare(windows, slipping.slip_settings())
    settings = outdoors.filter_settings()
    drive = load_outdoor_drive(settings.gauge_m, settings.encoder_tick_m)
    run = run_filter(drive, settings)
    tracks = {
        "wheels alone": (drive.wheels_s, wheels_alone(drive, settings.gauge_m)),
        "wheels and gyro": (drive.wheels_s, wheels_and_gyro(drive)),
        "filter": (run.times_s, run.positions_m),
    }
    compared = {name: compare_with_gps(*track, drive.gps_s, drive.gps_m) for name, track in tracks.items()}
    values = slip_values(methods) | outdoor_values(drive, run, compared)
    print(render_table(_rows(values), ["real vehicle", "measured", "target", ""], ["left", "right", "right"]))
    facts = [("commit", git_commit()), ("slip", slipping.source), ("outdoors", outdoors.source)]
    page = output_folder() / "recordings" / "index.html"
    page.parent.mkdir(parents=True, exist_ok=True)
    write_whole(page, recordings_page(windows, methods, drive, compared, run, values, facts))
    print(write_metrics("recordings", values, seed=SEED))
    print(page)
    return 0 if all(values[key] <= target.limit for key, target in TARGETS.items()) else 1


def _rows(values: dict[str, float]) -> list[list[str]]:
    rows = []
    for key, value in values.items():
        if key.endswith(("rms_low_m", "rms_high_m")):
            continue
        target = TARGETS.get(key)
        if target is None:
            rows.append([key, f"{value:.4g}"])
        else:
            word = coloured("PASS", "green") if value <= target.limit else coloured("MISS", "red")
            rows.append([key, f"{value:.4g}", f"<= {target.limit:g} {target.unit}", word])
    return rows


if __name__ == "__main__":
    sys.exit(main())
