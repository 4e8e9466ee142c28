"""Real recordings: the objects of the nodes replayed on vehicles they were not made for: ``make recordings``."""

from tracked_lab.recordings.dead_reckoning import wheels_alone, wheels_and_gyro
from tracked_lab.recordings.drive_windows import DriveWindows, load_drive_windows
from tracked_lab.recordings.filter_run import FilterRun, run_filter
from tracked_lab.recordings.gps_alignment import GpsComparison, compare_with_gps
from tracked_lab.recordings.outdoor_drive import OutdoorDrive, load_outdoor_drive
from tracked_lab.recordings.recording_file import RecordingError
from tracked_lab.recordings.slip_comparison import Method, compare
from tracked_lab.recordings.targets import TARGETS
from tracked_lab.recordings.vehicle import Vehicle, load_vehicle

__all__ = [
    "TARGETS",
    "DriveWindows",
    "FilterRun",
    "GpsComparison",
    "Method",
    "OutdoorDrive",
    "RecordingError",
    "Vehicle",
    "compare",
    "compare_with_gps",
    "load_drive_windows",
    "load_outdoor_drive",
    "load_vehicle",
    "run_filter",
    "wheels_alone",
    "wheels_and_gyro",
]
