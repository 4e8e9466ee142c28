"""Certificates and designs from files, told in words; no solver is needed."""

import json
from pathlib import Path

from robust_core.certificates import load_certificate
from robust_core.command_line.outcome import matrix_lines, proof_lines
from robust_core.design_files import FORMAT, load_design
from robust_core.errors import CertificateDamagedError


def tell(path: str, *, verify: bool) -> str:
    """What a file proves; with ``verify`` after repeating the proof in exact arithmetic.

    Raises
    ------
    CertificateError: if the file was changed, or does not prove what it claims.
    """
    lines = [f"# {path}", ""]
    if _is_design(path):
        design = load_design(path)
        certificate, verify = design.certificate, True
        for name, value in design.gains.items():
            lines += [f"{name} =", "", *(f"    {row}" for row in matrix_lines(value)), ""]
    else:
        certificate = load_certificate(path, verify=verify)
    lines += [f"- {line}" for line in proof_lines(certificate)]
    lines.append("- proof repeated in exact arithmetic: it holds" if verify else "- proof not repeated (certify does)")
    return "\n".join(lines)


def _is_design(path: str) -> bool:
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise CertificateDamagedError(f"{path}: cannot be read ({error})") from error
    return isinstance(content, dict) and content.get("format") == FORMAT
