"""The terminal weight and set of a controller that tracks moving references with a unicycle."""

from dataclasses import dataclass

import numpy as np

from robust_core.checks import finite_number
from robust_core.errors import ArgumentError
from robust_core.lmi.settings import SolverSettings
from robust_core.plants.tracking_error import TrackingError
from robust_core.rational import Floats
from robust_core.terminal.design import TerminalDesign, design_terminal


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandLimits:
    """Bounds on the commands: speed (m/s), yaw rate (rad/s), and |v| + d |w| <= belt speed for the half track d (m)."""

    speed_mps: tuple[float, float]
    yaw_rate_radps: float
    belt_mps: float
    half_track_m: float

    def __post_init__(self) -> None:
        low, high = (finite_number(f"speed_mps[{k}]", v) for k, v in enumerate(self.speed_mps))
        if low >= high:
            raise ArgumentError("speed_mps", "an increasing range", f"{self.speed_mps}")
        for name in ("yaw_rate_radps", "belt_mps", "half_track_m"):
            finite_number(name, getattr(self, name), low=0.0, open_low=True)

    def room(self, model: TrackingError) -> tuple[float, float, float]:
        """What references leave for feedback: speed (m/s), yaw rate (rad/s), belt speed (m/s).

        Raises
        ------
        ArgumentError: if they leave none of one.
        """
        slow, fast = model.speed_mps
        room = (
            min(self.speed_mps[1] - fast, slow - self.speed_mps[0]),
            self.yaw_rate_radps - model.yaw_rate_radps,
            self.belt_mps - fast - self.half_track_m * model.yaw_rate_radps,
        )
        if min(room) <= 0.0:
            raise ArgumentError(
                "model",
                "of references within the limits",
                f"room {room} of speed, yaw rate and belt",
                "slower references",
            )
        return room


def design_tracking_terminal(
    model: TrackingError,
    limits: CommandLimits,
    *,
    position: float,
    heading: float,
    speed: float,
    yaw_rate: float,
    settings: SolverSettings | None = None,
) -> TerminalDesign:
    """Weight, gain and set for the stage cost position |e_xy|^2 + heading e_3^2 + speed dv^2 + yaw_rate dw^2.

    The weight belongs to the error in the reference's frame: in the world's, turn its first two axes by the reference's
    heading. Position weighs both directions alike, so the stage cost is the same in both frames.

    Raises
    ------
    ArgumentError: for references that leave no room for feedback, or weights that are not positive.
    SolverError: if no design was found.
    """
    for name, value in (("position", position), ("heading", heading), ("speed", speed), ("yaw_rate", yaw_rate)):
        finite_number(name, value, low=0.0, open_low=True)
    Q, R = stage_cost(position=position, heading=heading, speed=speed, yaw_rate=yaw_rate)
    state_rows, input_rows, bounds = tracking_limits(model, limits)
    return design_terminal(
        model.system(), Q, R, state_rows=state_rows, input_rows=input_rows, bounds=bounds, settings=settings
    )


def stage_cost(*, position: float, heading: float, speed: float, yaw_rate: float) -> tuple[Floats, Floats]:
    """Q (3, 3) and R (2, 2)."""
    return np.diag([position, position, heading]), np.diag([speed, yaw_rate])


def tracking_limits(model: TrackingError, limits: CommandLimits) -> tuple[Floats, Floats, Floats]:
    """Rows C (5, 3), D (5, 2) and bounds b (5,) of |C e + D u| <= b: the commands' room, and psi of the model.

    Raises
    ------
    ArgumentError: for references that leave no room for feedback.
    """
    dv, dw, belt = limits.room(model)
    half, step = limits.half_track_m, model.heading_point * model.period_s
    state_rows = np.zeros((5, 3))
    state_rows[4, 2] = 1.0
    input_rows = np.array([[1.0, 0.0], [0.0, 1.0], [1.0, half], [1.0, -half], [0.0, step]])
    return state_rows, input_rows, np.array([dv, dw, belt, belt, model.heading_rad])
