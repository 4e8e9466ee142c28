"""What describes a named shape."""

from dataclasses import dataclass

from tracked_types.setting import check_settings, setting

SAMPLE_STEP_S = 0.05  # of every shape; divides the 0.2 s between two pieces of reference
SHAPES = ("line", "s_curve", "circle", "figure_eight", "stop_and_turn")


@dataclass(frozen=True, slots=True, kw_only=True)
class ShapeSettings:
    """Which shape, how large and how fast; every shape uses the fields that concern it."""

    shape: str = setting("s_curve", "named shape to drive", choices=SHAPES)
    length_m: float = setting(
        3.0, "line: its length; s_curve: advance along x; stop_and_turn: one side", unit="m", low=0.05, high=100.0
    )
    width_m: float = setting(
        0.5, "s_curve: sideways displacement of one swing, the first to the left", unit="m", low=-20.0, high=20.0
    )
    swings: int = setting(2, "s_curve: number of swings, to alternating sides", low=1, high=100)
    radius_m: float = setting(
        1.0, "circle: radius; figure_eight: radius of circles as long as its loops", unit="m", low=0.1, high=50.0
    )
    corners: int = setting(4, "stop_and_turn: corners of the polygon", low=2, high=36)
    speed_mps: float = setting(0.35, "cruise speed", unit="m/s", low=0.01, high=5.0)
    turn_rate_radps: float = setting(
        0.6, "stop_and_turn: cruise yaw rate on the spot", unit="rad/s", low=0.01, high=6.0
    )
    acceleration_mps2: float = setting(0.6, "peak acceleration and braking", unit="m/s2", low=0.01, high=10.0)
    yaw_acceleration_radps2: float = setting(2.0, "peak yaw acceleration of ramps", unit="rad/s2", low=0.01, high=20.0)

    def __post_init__(self) -> None:
        check_settings(self)
