"""Pictures of the recordings' page."""

from collections.abc import Mapping, Sequence

import numpy as np

from tracked_lab.recordings.filter_run import FilterRun
from tracked_lab.recordings.gps_alignment import ALIGNED_S, GpsComparison
from tracked_lab.recordings.outdoor_drive import OutdoorDrive
from tracked_lab.recordings.slip_comparison import Method
from tracked_report.plots.style import (
    MUTED,
    REFERENCE,
    Picture,
    legend_above,
    new_figure,
    styled,
    to_svg,
    variant_colour,
)


def window_errors(methods: Sequence[Method]) -> Picture:
    """Share of the windows whose end is missed by less than a distance."""
    with styled():
        figure = new_figure(7.0, 3.2)
        ax = figure.subplots()
        for index, method in enumerate(methods):
            errors = np.sort(method.errors_m)
            ax.plot(errors, np.arange(1, len(errors) + 1) / len(errors), color=variant_colour(index), label=method.key)
        ax.set(xlabel="distance of the reckoned end from ICP's (m)", ylabel="share of windows", xlim=(0.0, 1.2))
        legend_above(figure, [ax])
        title = "Windows that end within a distance"
        svg = to_svg(figure, "window-errors", title)
    return Picture("window-errors", title, "Further left is better. Real vehicle, windows of 1.95 s.", svg)


def tracks_over_gps(drive: OutdoorDrive, compared: Mapping[str, GpsComparison]) -> Picture:
    """All tracks over the fixes."""
    with styled():
        figure = new_figure(7.0, 5.2)
        ax = figure.subplots()
        ax.plot(drive.gps_m[:, 0], drive.gps_m[:, 1], ".", color=REFERENCE, markersize=2.5, label="GPS")
        for index, (name, comparison) in enumerate(compared.items()):
            ax.plot(comparison.track_m[:, 0], comparison.track_m[:, 1], color=variant_colour(index), label=name)
        ax.set(xlabel="east (m)", ylabel="north (m)", aspect="equal")
        legend_above(figure, [ax])
        title = "Tracks over GPS"
        svg = to_svg(figure, "tracks", title)
    caption = f"Each track is turned and shifted to fit the first {ALIGNED_S:.0f} s. Real vehicle."
    return Picture("tracks", title, caption, svg)


def distance_over_time(drive: OutdoorDrive, compared: Mapping[str, GpsComparison]) -> Picture:
    """Distance of every track from GPS."""
    with styled():
        figure = new_figure(7.0, 2.8)
        ax = figure.subplots()
        for index, (name, comparison) in enumerate(compared.items()):
            ax.plot(drive.gps_s, comparison.distance_m, color=variant_colour(index), label=name)
        ax.axvspan(0.0, ALIGNED_S, color=MUTED, alpha=0.15, linewidth=0.0)
        ax.set(xlabel="time (s)", ylabel="distance from GPS (m)")
        legend_above(figure, [ax])
        title = "Distance from GPS over time"
        svg = to_svg(figure, "distances", title)
    return Picture("distances", title, "Grey: the time to which the tracks are fitted.", svg)


def bias_over_time(run: FilterRun) -> Picture:
    """What the filter believes of the gyro's bias."""
    with styled():
        figure = new_figure(7.0, 2.2)
        ax = figure.subplots()
        ax.plot(run.bias_s, 1e3 * run.bias_radps, color=variant_colour(1))
        for begin_s, end_s in run.rests_s:
            ax.axvspan(begin_s, end_s, color=MUTED, alpha=0.25, linewidth=0.0)
        ax.set(xlabel="time (s)", ylabel="bias (mrad/s)")
        title = "Bias of the gyro as the filter learns it"
        svg = to_svg(figure, "bias", title)
    return Picture("bias", title, "Grey: the vehicle stands, and the gyro shows its bias.", svg)
