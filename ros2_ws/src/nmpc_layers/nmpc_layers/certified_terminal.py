"""The certified terminal weight of the upper layer, (5.2.21), and the references it is for."""

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from nmpc_layers.drive_limits import DriveLimits
from nmpc_layers.solver.terminal_weight import TerminalWeight
from nmpc_layers.solver.weights import Weights
from robust_core.errors import ArgumentError, CertificateError
from robust_core.plants.tracking_error import TrackingError
from robust_core.terminal import CommandLimits, ProvenTerminal, load_tracking_terminal
from tracked_types.checked_yaml import CheckedFileError, CheckedModel

Array = NDArray[np.float64]
REMEDY = "set terminal to scaled, or make one with python -m nmpc_layers.design_terminal"
_SLACK = 1e-9  # references that keep the bounds but for rounding are covered


class TerminalSource(CheckedModel):
    """Where a weights file keeps a certified terminal weight, and the references it is for.

    file: relative to the weights file. speed_mps: range of the reference's speed, which must be positive: beside a
    reference at rest no weight descends. yaw_rate_radps: bound of its yaw rate. heading_rad: bound of the heading error
    in the terminal set.
    """

    file: str
    speed_mps: tuple[float, float]
    yaw_rate_radps: float
    heading_rad: float

    def tracking_error(self, period_s: float, heading_point: float) -> TrackingError:
        """The model that the weight is certified for, with the step and the heading's point of a layer."""
        return TrackingError(
            period_s=period_s,
            speed_mps=self.speed_mps,
            yaw_rate_radps=self.yaw_rate_radps,
            heading_rad=self.heading_rad,
            heading_point=heading_point,
        )


@dataclass(frozen=True, slots=True)
class CertifiedTerminal:
    """A terminal weight that was proven when it was read; level: of its invariant set {e'P e <= level}."""

    weight: TerminalWeight
    level: float
    speed_mps: tuple[float, float]
    yaw_rate_radps: float

    def covers(self, inputs: Array) -> bool:
        """Whether the proof is about a reference that goes on with ``inputs`` (2,), speed and yaw rate."""
        speed, yaw_rate = inputs.tolist()
        slow, fast = self.speed_mps
        return bool(slow - _SLACK <= speed <= fast + _SLACK and abs(yaw_rate) <= self.yaw_rate_radps + _SLACK)


def command_limits(limits: DriveLimits) -> CommandLimits:
    """The limits of the commands as the design of terminal weights wants them."""
    return CommandLimits(
        speed_mps=(limits.speed_min_mps, limits.speed_max_mps),
        yaw_rate_radps=limits.yaw_rate_max_radps,
        belt_mps=limits.track_speed_mps,
        half_track_m=limits.half_gauge_m,
    )


def load_certified_terminal(
    folder: Path,
    source: TerminalSource,
    weights: Weights,
    limits: DriveLimits,
    *,
    period_s: float,
    heading_point: float,
) -> CertifiedTerminal:
    """Read the weight, repeat its proof in exact arithmetic, and hold it against layer and robot.

    Parameters
    ----------
    folder: that of the weights file.
    period_s, heading_point: of the layer's model, see `MotionParameters`.

    Raises
    ------
    CheckedFileError: if the file is missing, damaged, not proven, or for another model, weights or limits.
    """
    path = folder / source.file
    try:
        model = source.tracking_error(period_s, heading_point)
        # Many runs in one process read the same file; once changed, it counts as another one.
        found = _proven(path, path.stat().st_mtime_ns, model, weights, limits)
    except OSError as error:
        raise CheckedFileError(f"{path}: cannot be read ({error.strerror}); {REMEDY}") from error
    except ArgumentError as error:
        raise CheckedFileError(f"{path}: references without a terminal weight: {error}; {REMEDY}") from error
    except CertificateError as error:
        raise CheckedFileError(f"{error}; this layer steps {period_s:g} s (1 / rate_hz); {REMEDY}") from error
    return CertifiedTerminal(TerminalWeight.of(found.P), found.level, source.speed_mps, source.yaw_rate_radps)


@lru_cache(maxsize=16)
def _proven(
    path: Path, _changed_ns: int, model: TrackingError, weights: Weights, limits: DriveLimits
) -> ProvenTerminal:
    return load_tracking_terminal(
        path,
        model,
        command_limits(limits),
        position=weights.position,
        heading=weights.heading,
        speed=weights.speed,
        yaw_rate=weights.yaw_rate,
    )
