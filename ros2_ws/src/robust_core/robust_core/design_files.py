"""Designs as files that nodes load: the gains are those that the certificate within is about, and it is verified.

Most certificates name the gains themselves. One on a closed loop (design D) does not; the file then holds the open loop
too, and the loop closed by the gains must be the certificate's model, digit by digit.
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from robust_core.certificates import Certificate
from robust_core.certificates.files import from_content, to_content
from robust_core.errors import ArgumentError, CertificateDamagedError, CertificateMismatchError
from robust_core.models import PolytopicSystem
from robust_core.rational import Floats, exact_array, to_float
from robust_core.theorems.base import Model

FORMAT = "robust_core design 1"
_KEYS = {"format", "gains", "open_loop", "certificate"}


@dataclass(frozen=True, slots=True)
class ProvenGains:
    """Arrays by name (K; A, B, C of a filter; E, X of an observer; K, P, level (1,) of a terminal weight) and the
    certificate of what they do."""

    gains: dict[str, Floats]
    certificate: Certificate


def gains_of(certificate: Certificate) -> dict[str, Floats]:
    """The gains that a certificate is about, as the floats nearest to them.

    Raises
    ------
    ArgumentError: for a certificate that is about no design.
    """
    theorem: Any = certificate.theorem
    if getattr(theorem, "gains", ()):
        named = {"K": theorem.gains}
    elif hasattr(theorem, "filtering"):
        named = {name: getattr(theorem.filtering, name) for name in "ABC"}
    elif hasattr(theorem, "observer"):
        named = {name: getattr(theorem.observer, name) for name in "EX"}
    elif hasattr(theorem, "level") and certificate.values is not None:
        weight, level = theorem.level(certificate.values)
        return {"K": to_float(exact_array(theorem.gain)), "P": weight, "level": np.array([level])}
    else:
        kinds = "about gains, a filter, an observer or a terminal weight"
        raise ArgumentError("certificate", kinds, certificate.claim)
    return {name: to_float(exact_array(value)) for name, value in named.items()}


def save_design(
    certificate: Certificate, path: Path | str, *, gains: Any = None, open_loop: PolytopicSystem | None = None
) -> Path:
    """Write a design and return its path.

    Parameters
    ----------
    gains, open_loop: vertex gains (m, r, n) as decimals and the model that they close to that of the certificate, where
        the certificate does not name them itself.

    Raises
    ------
    ArgumentError: for a certificate that is about no design, or about another loop.
    """
    if not certificate.feasible:
        raise ArgumentError("certificate", "about a design that works", certificate.claim)
    named = gains_of(certificate) if open_loop is None else {"K": np.asarray(gains, dtype=np.float64)}
    if open_loop is not None and not _closes(open_loop, named["K"], certificate):
        raise ArgumentError("gains", "those that the certificate's loop is closed by", "others")
    content = {
        "format": FORMAT,
        "gains": {name: value.tolist() for name, value in named.items()},
        "open_loop": None if open_loop is None else open_loop.to_json(),
        "certificate": to_content(certificate),
    }
    target = Path(path)
    target.write_text(json.dumps(content, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    return target


def load_design(path: Path | str, *, model: Model | None = None) -> ProvenGains:
    """Gains whose proof was just repeated in exact arithmetic; no solver is needed.

    Parameters
    ----------
    model: if given, the design must be for exactly this model (of the open loop).

    Raises
    ------
    CertificateDamagedError: if the file is no design, or any digit of it was changed, the gains included.
    CertificateMismatchError, ProofFailedError: as for certificates.
    """
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise CertificateDamagedError(f"{path}: cannot be read as a design ({error})") from error
    if not isinstance(content, dict) or content.get("format") != FORMAT or set(content) != _KEYS:
        raise CertificateDamagedError(f"{path}: is not a design of the format {FORMAT!r}")
    certificate = from_content(content["certificate"], str(path))
    try:
        gains = {str(name): np.array(value, dtype=np.float64) for name, value in content["gains"].items()}
        if content["open_loop"] is None:
            plant, named = certificate.model, gains_of(certificate)
            same = gains.keys() == named.keys() and all(np.array_equal(gains[k], named[k]) for k in named)
        else:
            plant = loop = PolytopicSystem.from_json(content["open_loop"])
            same = _closes(loop, gains["K"], certificate)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise CertificateDamagedError(f"{path}: its content is malformed ({error})") from error
    if not same:
        raise CertificateDamagedError(f"{path}: its gains are not those that its certificate is about")
    if model is not None and model.digest != plant.digest:
        raise CertificateMismatchError(f"{path}: is for another model than the one given")
    certificate.verify("exact")
    return ProvenGains(gains, certificate)


def _closes(open_loop: PolytopicSystem, K: Floats, certificate: Certificate) -> bool:
    """Whether decimal gains close the loop that a certificate is about."""
    decimals = np.array([repr(value) for value in np.ravel(K).tolist()], dtype=object).reshape(np.shape(K))
    return open_loop.closed_loop(decimals).digest == certificate.model.digest
