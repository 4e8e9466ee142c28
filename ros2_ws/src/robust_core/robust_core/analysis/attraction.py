"""Certified regions of attraction: sublevel sets of a Lyapunov function inside the box where it was proven.

Theorems whose rates or vertices hold in a box say nothing outside of it, so their conclusion is local (erratum 2.3).
If V >= c on the faces of the box, then {x in the box : V(x) < c} is never left and every motion from it goes to the
origin.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from robust_core.analysis.decide import Result, decide
from robust_core.certificates import Certificate
from robust_core.certificates.primal import check_exact, check_float
from robust_core.checks import finite_array
from robust_core.errors import ArgumentError, NotProvenError, ProofFailedError
from robust_core.lmi.coefficients import Family, coefficients
from robust_core.lmi.objective import minimise
from robust_core.lmi.settings import SolverSettings
from robust_core.models import PolytopicSystem
from robust_core.rational import Exact, Floats, definite, exact_array, rational, to_float
from robust_core.theorems.lyapunov import LyapunovTheorem

_BLENDS = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1)


@dataclass(frozen=True, slots=True)
class Region:
    """{x : |x_i| <= ``half_widths``_i and V(x) < ``level``}, V(x) = x^T (sum_r sigma_r P_r) x of ``certificate``.

    ``inner`` (m, n, n) are P at the attained vertices: the ellipsoid x^T P x < level of the largest of them is inside.
    """

    certificate: Certificate
    half_widths: Floats
    level: float
    inner: Floats

    def verify(self) -> None:
        """Repeat in exact arithmetic that V decreases in the box and is at least ``level`` on its faces.

        Raises
        ------
        ProofFailedError: if it does not.
        """
        self.certificate.verify("exact")
        exact = attained_matrices(self.certificate, exact=True)
        if not _covers(exact, exact_array(self.half_widths), rational(self.level)):
            raise ProofFailedError("V is below the level somewhere on the faces of the box")


def certified_region(certificate: Certificate, half_widths: Any) -> Region:
    """The largest level that the attained vertices guarantee: V on a face is at least its least value at a vertex.

    Parameters
    ----------
    half_widths: (n,) of the box |x_i| <= b_i in which the certificate's rates and vertices hold.

    Raises
    ------
    ArgumentError: for a certificate that is no solution of a stability theorem.
    """
    P = attained_matrices(certificate, exact=False)
    box = _box(half_widths, P.shape[-1])
    spread = np.diagonal(np.linalg.inv(P), axis1=-2, axis2=-1)
    level = float((box**2 / spread).min())
    exact, exact_box = attained_matrices(certificate, exact=True), exact_array(box)
    for shrink in (2.0**-40, 2.0**-30, 2.0**-20):
        if _covers(exact, exact_box, rational(level * (1.0 - shrink))):
            return Region(certificate, box, level * (1.0 - shrink), P)
    raise ProofFailedError("no level could be proven: P is too badly conditioned")


def maximised_region(
    theorem: LyapunovTheorem, model: PolytopicSystem, half_widths: Any, *, settings: SolverSettings | None = None
) -> Region:
    """A region of attraction made large: least sum of traces of P with V >= 1 on the faces.

    The optimum touches its inequalities; it is moved towards a solution with room, as little as makes the proof pass.

    Raises
    ------
    NotProvenError: if the theorem does not hold for the model.
    """
    first: Result = decide(theorem, model)
    certificate = first.require(proven=False)
    special = theorem.specialised(model)
    box, data, unknowns = _box(half_widths, model.states), special.data(model), special.unknowns(model)
    mixing = to_float(model.simplices.mixing())

    def attained(probes: Any) -> Any:
        P = special.vertex_matrices(model, probes)
        return (mixing @ P.reshape(*P.shape[:-2], -1)).reshape(*P.shape[:-3], len(mixing), *P.shape[-2:])

    families = coefficients(unknowns, lambda probes: special.constraints(data, probes))
    stack = np.asarray(attained(unknowns.probes()))
    linear = stack[1:] - stack[0]
    sides = [-np.outer(side, side) for side in np.diag(1.0 / box)]
    for side in sides:
        families += (Family("V >= 1 on the faces", np.broadcast_to(side, stack[0].shape), linear, 1.0, False),)
    found = minimise(families, linear=np.trace(linear, axis1=2, axis2=3).sum(axis=1), settings=settings)
    roomy = unknowns.pack(certificate.values or {}) / certified_region(certificate, box).level
    for blend in _BLENDS:
        values = unknowns.unpack((1.0 - blend) * found.vector + blend * 1.01 * roomy)
        try:
            margins = check_float(special, model, values)
            check_exact(special, model, values)
        except ProofFailedError:
            continue
        better = replace(certificate, theorem=special, values=values, margins=margins)
        return certified_region(better, box)
    raise NotProvenError("the enlarged region could not be proven; use certified_region")


def attained_matrices(certificate: Certificate, *, exact: bool) -> Any:
    """P at the attained vertices (v, n, n)."""
    P = certificate.vertex_matrices()
    model: Any = certificate.model
    mixing: Exact = model.simplices.mixing()
    P = exact_array(P) if exact else P
    weights = mixing if exact else to_float(mixing)
    return (weights @ P.reshape(len(P), -1)).reshape(len(weights), *P.shape[1:])


def _covers(P: Exact, box: Exact, level: Any) -> bool:
    """P_k - level e_i e_i^T / b_i^2 >= 0 for every vertex and side."""
    for side, half in enumerate(box):
        lessened = P.copy()
        lessened[:, side, side] = lessened[:, side, side] - level / (half * half)
        if not definite(lessened, strict=False).all():
            return False
    return True


def _box(half_widths: Any, size: int) -> Floats:
    box = finite_array("half_widths", half_widths, (size,), "one half width per state")
    if not (box > 0.0).all():
        raise ArgumentError("half_widths", "positive", str(box.tolist()))
    return box
