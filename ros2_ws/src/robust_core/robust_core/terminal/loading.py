"""The terminal weight of a tracking controller out of a file, proven anew and held against what it is used for."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from robust_core.design_files import load_design
from robust_core.errors import CertificateMismatchError
from robust_core.plants.tracking_error import TrackingError
from robust_core.rational import Floats, exact_array
from robust_core.terminal.theorem import TerminalIngredient
from robust_core.terminal.tracking import CommandLimits, stage_cost, tracking_limits


@dataclass(frozen=True, slots=True)
class ProvenTerminal:
    """Weight P (3, 3), gain K (2, 3) and level c of the set {e'P e <= c}, for errors in the reference's frame."""

    P: Floats
    K: Floats
    level: float


def load_tracking_terminal(
    path: Path | str,
    model: TrackingError,
    limits: CommandLimits,
    *,
    position: float,
    heading: float,
    speed: float,
    yaw_rate: float,
) -> ProvenTerminal:
    """A design by `design_tracking_terminal` that `save_design` wrote. Needs no solver.

    The proof is repeated in exact arithmetic, and the design must be for exactly this model and these weights, and keep
    these limits or tighter ones.

    Raises
    ------
    CertificateDamagedError: if the file cannot be read, is no such design, or any digit of it was changed.
    CertificateMismatchError: if it is for another model, other weights or wider limits; the text says which.
    ProofFailedError: if its inequalities do not hold.
    """
    design = load_design(path, model=model.system())
    theorem: Any = design.certificate.theorem
    if not isinstance(theorem, TerminalIngredient):
        raise CertificateMismatchError(f"{path}: is no terminal weight, but about {design.certificate.claim}")
    weights = stage_cost(position=position, heading=heading, speed=speed, yaw_rate=yaw_rate)
    for name, matrix, certified in zip(("state", "input"), weights, (theorem.Q, theorem.R), strict=True):
        if not np.array_equal(exact_array(matrix), exact_array(certified)):
            raise CertificateMismatchError(
                f"{path}: is for other {name} weights than {np.diag(matrix).tolist()}: "
                f"{[float(value) for value in np.diag(exact_array(certified))]}"
            )
    state_rows, input_rows, bounds = tracking_limits(model, limits)
    rows = exact_array(state_rows) + exact_array(input_rows) @ exact_array(theorem.gain)
    if not np.array_equal(rows, exact_array(theorem.rows)) or (exact_array(theorem.bounds) > exact_array(bounds)).any():
        raise CertificateMismatchError(f"{path}: is for other limits of the commands than {limits}")
    gains = design.gains
    return ProvenTerminal(gains["P"], gains["K"], float(gains["level"][0]))
