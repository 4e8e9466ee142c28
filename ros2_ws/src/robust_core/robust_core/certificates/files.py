"""Certificates as JSON files that fail loudly when a single digit is changed."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from robust_core.certificates.certificate import Certificate
from robust_core.errors import ArgumentError, CertificateDamagedError, CertificateMismatchError
from robust_core.models.filter_plant import FilterPlant
from robust_core.models.lipschitz_plant import LipschitzPlant
from robust_core.models.polytope import PolytopicSystem, digest_of
from robust_core.rational import exact_array, to_text
from robust_core.theorems import theorem_from_json
from robust_core.theorems.base import Model

FORMAT = "robust_core certificate 1"
_KEYS = {"format", "theorem", "model", "model_digest", "claim", "values", "multipliers", "margins", "digest"}

MODEL_KINDS: dict[str, Callable[[Any], Model]] = {
    "polytopic": PolytopicSystem.from_json,
    "filter_plant": FilterPlant.from_json,
    "lipschitz_plant": LipschitzPlant.from_json,
}
"""How models are read back, by the ``kind`` that their to_json gives."""


def to_content(certificate: Certificate) -> dict[str, Any]:
    """Plain data. All numbers are texts, so that the digest covers each of their digits."""
    content = {
        "format": FORMAT,
        "theorem": certificate.theorem.to_json(),
        "model": certificate.model.to_json(),
        "model_digest": certificate.model.digest,
        "claim": certificate.claim,
        "values": _texts(certificate.values, lambda value: [repr(v) for v in np.ravel(value).tolist()]),
        "multipliers": _texts(certificate.multipliers, to_text),
        "margins": {name: repr(float(value)) for name, value in certificate.margins.items()},
    }
    return {**content, "digest": digest_of(content)}


def save_certificate(certificate: Certificate, path: Path | str) -> Path:
    """Write a certificate and return its path."""
    target = Path(path)
    target.write_text(json.dumps(to_content(certificate), indent=1, allow_nan=False) + "\n", encoding="utf-8")
    return target


def load_certificate(path: Path | str, *, model: Model | None = None, verify: bool = True) -> Certificate:
    """Read a certificate, check that it is whole and, unless told otherwise, repeat its proof exactly.

    Parameters
    ----------
    model: if given, the certificate must be about exactly this model.

    Raises
    ------
    CertificateDamagedError: if the file cannot be read or any digit of it was changed.
    CertificateMismatchError: if it is about another model, or a theorem that is not known.
    ProofFailedError: if its inequalities do not hold.
    """
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise CertificateDamagedError(f"{path}: cannot be read as a certificate ({error})") from error
    certificate = from_content(content, str(path))
    if model is not None and certificate.model.digest != model.digest:
        raise CertificateMismatchError(f"{path}: is about another model than the one given")
    if verify:
        certificate.verify("exact")
    return certificate


def from_content(content: Any, name: str = "certificate") -> Certificate:
    """A certificate from plain data; the digests are checked, the proof is not."""
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise CertificateDamagedError(f"{name}: is not a certificate of the format {FORMAT!r}")
    if set(content) != _KEYS:
        raise CertificateDamagedError(f"{name}: fields are missing or unknown: {sorted(set(content) ^ _KEYS)}")
    if digest_of({key: value for key, value in content.items() if key != "digest"}) != content["digest"]:
        raise CertificateDamagedError(f"{name}: was changed after it was written (its digest does not match)")
    try:
        kind = MODEL_KINDS.get(content["model"]["kind"])
        if kind is None:
            raise CertificateMismatchError(f"{name}: no model is of the kind {content['model']['kind']!r}")
        model, theorem = kind(content["model"]), theorem_from_json(content["theorem"])
        values = _arrays(content["values"], lambda texts: np.array([float(v) for v in texts], dtype=np.float64))
        multipliers = _arrays(content["multipliers"], exact_array)
        margins = {key: float(value) for key, value in content["margins"].items()}
        certificate = Certificate(theorem, model, values, multipliers, margins)
        if values is not None:
            theorem.unknowns(model).pack(values)
    except (KeyError, TypeError, ValueError, AttributeError, ArgumentError) as error:
        raise CertificateDamagedError(f"{name}: its content is malformed ({error})") from error
    if model.digest != content["model_digest"]:
        raise CertificateMismatchError(f"{name}: its model is not the one that it was made for")
    return certificate


def _texts(arrays: Mapping[str, Any] | None, text: Callable[[Any], list[str]]) -> dict[str, Any] | None:
    if arrays is None:
        return None
    return {name: {"shape": list(np.shape(array)), "values": text(array)} for name, array in arrays.items()}


def _arrays(content: Any, read: Callable[[Any], Any]) -> dict[str, Any] | None:
    if content is None:
        return None
    return {name: read(entry["values"]).reshape(entry["shape"]) for name, entry in content.items()}
