"""Tables of a drive, for the page and for the terminal."""

from collections.abc import Mapping, Sequence

from tracked_report.html_report import Cell, Table, Tone
from tracked_report.metrics.comparison import reduction_percent
from tracked_report.run_record import RunRecord
from tracked_report.terminal import Align, coloured, render_table

Values = Mapping[str, float]
_NUMBERS: Align = "right"
_COVERED_PERCENT = 98.0

TABLE_5_1 = (
    ("ptop_x_m", "PtoP x (m)"),
    ("ptop_y_m", "PtoP y (m)"),
    ("ptop_theta_rad", "PtoP heading (rad)"),
    ("rms_x_m", "RMS x (m)"),
    ("rms_y_m", "RMS y (m)"),
    ("rms_theta_rad", "RMS heading (rad)"),
)
OTHER_FIGURES = (
    ("estimated.covered_percent", "reference covered by estimates (%)"),
    ("estimated.max_distance_m", "largest distance to the reference, estimated (m)"),
    ("true.max_distance_m", "largest distance to the reference, true (m)"),
    ("estimated.final_distance_m", "distance left at the end, estimated (m)"),
    ("true.final_distance_m", "distance left at the end, true (m)"),
    ("estimated.final_theta_rad", "heading left at the end, estimated (rad)"),
    ("estimated.settling_s", "settling after the reference has come to rest, estimated (s)"),
    ("estimated.recovery_s", "recovery from the sudden change of pose, estimated (s)"),
    ("true.recovery_s", "recovery from the sudden change of pose, true (s)"),
    ("slip.speed_rms_mps", "slip speed, RMS error of the estimate (m/s)"),
    ("slip.yaw_rate_rms_radps", "slip yaw rate, RMS error of the estimate (rad/s)"),
    ("ride.vertical_peak_mps2", "vertical acceleration, peak (m/s²)"),
    ("ride.vertical_rms_mps2", "vertical acceleration, RMS (m/s²)"),
    ("command.rms_acceleration_mps2", "commands, RMS acceleration (m/s²)"),
    ("command.rms_jerk_mps3", "commands, RMS jerk (m/s³)"),
    ("command.rms_yaw_acceleration_radps2", "commands, RMS yaw acceleration (rad/s²)"),
    ("command.violations", "commands outside the limits"),
    ("solver.upper_median_ms", "upper layer, median tick, thread CPU (ms)"),
    ("solver.upper_p99_ms", "upper layer, 99 % of ticks within (ms)"),
    ("solver.lower_median_ms", "lower layer, median tick, thread CPU (ms)"),
    ("solver.lower_p99_ms", "lower layer, 99 % of ticks within (ms)"),
    ("loop.command_period_median_ms", "period of the commands, wall clock, median (ms)"),
    ("loop.command_period_p99_ms", "period of the commands, wall clock, 99 % within (ms)"),
    ("loop.command_missed_percent", "commands left out (%)"),
    ("latency.odometry_to_command_median_ms", "odometry to command, wall clock, median (ms)"),
    ("latency.odometry_to_command_p99_ms", "odometry to command, wall clock, 99 % within (ms)"),
)


def number(value: float | None) -> str:
    """A figure for a table: whole numbers as they are, others to four digits; a dash where there is none."""
    if value is None:
        return "–"
    if value == int(value) and abs(value) < 1e6:
        return str(int(value))
    return f"{value:.4f}" if 0.001 <= abs(value) < 1.0 else f"{value:.4g}"


def reduction_text(percent: float) -> str:
    """``51.9 % less`` or ``3.0 % more``."""
    return f"{abs(percent):.1f} % {'less' if percent >= 0.0 else 'more'}"


def tracking_table(values: Values, variants: Sequence[str], baseline: str, frame: str) -> Table:
    """Table 5.1: (5.3.1) and (5.3.2) of one frame, a column per variant with its reduction against the baseline."""
    others = [name for name in variants if name != baseline]
    headers = ["error", baseline]
    for name in others:
        headers += [name, f"against {baseline}"]
    rows = []
    for key, label in TABLE_5_1:
        base = values.get(f"{baseline}.{frame}.{key}")
        row: list[Cell | str] = [label, number(base)]
        for name in others:
            value = values.get(f"{name}.{frame}.{key}")
            row += [number(value), _reduction_cell(base, value)]
        rows.append(row)
    return Table(headers, rows, f"Tracking error, {frame} frame")


def other_table(values: Values, variants: Sequence[str]) -> Table:
    """The other figures, one column per variant; rows that nobody has are left out."""
    rows = []
    for key, label in OTHER_FIGURES:
        row = [values.get(f"{name}.{key}") for name in variants]
        if any(value is not None for value in row):
            rows.append([label, *map(number, row)])
    return Table(["figure", *variants], rows)


def channel_table(runs: Mapping[str, RunRecord]) -> Table:
    """What was recorded: rows per channel and variant."""
    names = list(dict.fromkeys(name for record in runs.values() for name in record.channels))
    rows = [
        [name, *(str(len(record.channel(name))) if name in record.channels else "–" for record in runs.values())]
        for name in names
    ]
    return Table(["channel", *runs], rows, "Rows recorded")


def coverage_warning(values: Values, variants: Sequence[str]) -> str:
    """Which runs have samples for only a part of the reference, so that their figures say less; empty if none."""
    told = []
    for name in variants:
        for frame, what in (("estimated", "estimates"), ("true", "truth")):
            share = values.get(f"{name}.{frame}.covered_percent", 100.0)
            if share < _COVERED_PERCENT:
                told.append(f"{what} of {name} cover {share:.0f} % of the reference")
    return f"Attention: {'; '.join(told)}. Errors in the gaps are not counted." if told else ""


def terminal_summary(values: Values, variants: Sequence[str], baseline: str) -> str:
    """Short table for the terminal: the tracking errors of both frames as in Table 5.1."""
    blocks = []
    for frame in ("estimated", "true"):
        table = tracking_table(values, variants, baseline, frame)
        if all(cell.text == "–" for row in table.cells() for cell in row[1:]):
            continue
        rows = [[_for_terminal(cell) for cell in row] for row in table.cells()]
        align: list[Align] = ["left", *(_NUMBERS for _ in table.headers[1:])]
        blocks.append(f"{table.caption}\n{render_table(rows, table.headers, align, indent='  ')}")
    blocks += [warning] if (warning := coverage_warning(values, variants)) else []
    return "\n\n".join(blocks) or "No tracking figures: nothing to compare was recorded."


def _for_terminal(cell: Cell) -> str:
    colours = {"good": "green", "bad": "red"}
    return coloured(cell.text, colours[cell.tone]) if cell.tone in colours else cell.text


def _reduction_cell(base: float | None, value: float | None) -> Cell:
    if base is None or value is None or base == 0.0:
        return Cell("–")
    percent = reduction_percent(base, value)
    tone: Tone = "good" if percent > 0.0 else "bad"
    return Cell(reduction_text(percent), tone)
