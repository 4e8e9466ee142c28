"""The real recordings as one page that needs nothing else."""

from collections.abc import Mapping, Sequence

from tracked_lab.recordings.drive_windows import DriveWindows
from tracked_lab.recordings.filter_run import FilterRun
from tracked_lab.recordings.gps_alignment import GpsComparison
from tracked_lab.recordings.outdoor_drive import OutdoorDrive
from tracked_lab.recordings.recording_plots import bias_over_time, distance_over_time, tracks_over_gps, window_errors
from tracked_lab.recordings.slip_comparison import Method
from tracked_lab.recordings.targets import TARGETS
from tracked_report.html_report import Cell, Headline, Report, Section, Table, Tone, render_html

_SUBTITLE = (
    "The very objects that the nodes wrap, replayed on real skid-steer vehicles they were not made for. Nothing on "
    "this page is simulated."
)
_SLIP_TEXT = (
    "Each window starts at the pose that lidar ICP saw; the error is the distance of the reckoned end from ICP's. The "
    "yaw rate from lidar ICP stands in for the gyro, since the recording's own IMU heading contradicts it, so this "
    "measures the slip object alone. Methods that fit numbers predict each fifth of the windows from the other four."
)
_OUTDOOR_TEXT = (
    "The whole odometry filter, fed with the recorded IMU and wheel counts in the order of their stamps. Its settings "
    "are the vehicle's own numbers; the wheel counts are taken back from the recorded odometry's pose. Tracks are "
    "turned and shifted to fit GPS in the first minute and compared with every fix of the drive."
)


def recordings_page(
    windows: DriveWindows,
    methods: Sequence[Method],
    drive: OutdoorDrive,
    compared: Mapping[str, GpsComparison],
    run: FilterRun,
    values: Mapping[str, float],
    facts: Sequence[tuple[str, str]],
) -> str:
    """The page's HTML; ``values`` are the metrics, by key."""
    return render_html(
        Report(
            "Real recordings",
            _SUBTITLE,
            facts=facts,
            headlines=[_headline(key, values[key]) for key in TARGETS],
            sections=[_slip(windows, methods, values), _outdoor(drive, compared, run, values)],
        )
    )


def verdict(key: str, value: float) -> Tone:
    """Whether a figure reaches its target; plain where it has none."""
    return "plain" if key not in TARGETS else ("good" if value <= TARGETS[key].limit else "bad")


def _headline(key: str, value: float) -> Headline:
    target = TARGETS[key]
    return Headline(
        f"{value:.3g} {target.unit}", target.label, f"at most {target.limit:g} {target.unit}", verdict(key, value)
    )


def _slip(windows: DriveWindows, methods: Sequence[Method], values: Mapping[str, float]) -> Section:
    rows: list[list[Cell | str]] = []
    for method in methods:
        key = f"recordings.slip.{method.key}.rms_m"
        low, high = (values[f"recordings.slip.{method.key}.rms_{end}_m"] for end in ("low", "high"))
        shown = Cell(f"{values[key]:.3f}", verdict(key, values[key]))
        rows.append([method.name, str(method.fitted), shown, f"{low:.3f} to {high:.3f}", f"{method.median_m:.3f}"])
    left_out = f"{windows.left_out} are left out, where values are missing or the pose jumps"
    table = Table(
        ["", "fitted numbers", "RMS (m)", "95 % interval", "median (m)"],
        rows,
        caption=f"{len(windows)} windows of 1.95 s; {left_out}.",
    )
    return Section("Slip law on a Husky, windows of two seconds", _SLIP_TEXT, [table, window_errors(methods)])


def _outdoor(
    drive: OutdoorDrive, compared: Mapping[str, GpsComparison], run: FilterRun, values: Mapping[str, float]
) -> Section:
    rows: list[list[Cell | str]] = []
    for name, comparison in compared.items():
        key = f"recordings.outdoor.{name.replace(' ', '_')}.mean_m"
        mean = Cell(f"{comparison.mean_m:.1f}", verdict(key, comparison.mean_m))
        rows.append([name, mean, f"{comparison.end_m:.1f}", f"{comparison.largest_m:.1f}"])
    distances = Table(
        ["", "mean (m)", "at the end (m)", "largest (m)"],
        rows,
        caption=f"Distance from GPS over {drive.duration_s:.0f} s and {drive.travel_m:.0f} m.",
    )
    offences = sum(run.offences.values())
    health = Table(
        ["", "IMU", "wheels"],
        [
            ["longest time without a sample taken in, moving (s)", *_of_sensors(run.longest_deaf_s, ".2f")],
            ["mean normalised squared innovation (1 is consistent)", *_of_sensors(run.nis, ".3f")],
        ],
        caption=(
            f"Samples refused or blamed: {offences}. Bias of the gyro at the long rest: mean reading "
            f"{1e3 * values['recordings.outdoor.gyro_at_rest_radps']:.2f} mrad/s, learnt "
            f"{1e3 * values['recordings.outdoor.bias_radps']:.2f} mrad/s."
        ),
    )
    pictures = [tracks_over_gps(drive, compared), distance_over_time(drive, compared), bias_over_time(run)]
    return Section("Odometry filter on a Husky outdoors", _OUTDOOR_TEXT, [distances, health, *pictures])


def _of_sensors(figures: Mapping[str, float], form: str) -> list[str]:
    return [f"{figures[sensor]:{form}}" if sensor in figures else "none" for sensor in ("imu", "tracks")]
