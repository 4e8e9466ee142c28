"""What a command found: a verdict, words, gains, a certificate and a picture."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from robust_core.certificates import Certificate, save_certificate
from robust_core.design_files import save_design
from robust_core.errors import MissingDependencyError
from robust_core.verdict import Verdict


@dataclass(frozen=True, slots=True)
class Outcome:
    """``asked`` and ``found`` are lines for the reader; ``gains`` arrays by name; ``draw`` fills a figure.

    ``open_loop``: the model that the gains are for, where the certificate is about the closed loop.
    """

    verdict: Verdict
    reason: str
    asked: tuple[str, ...]
    found: tuple[str, ...]
    certificate: Certificate | None = None
    gains: Mapping[str, Any] = field(default_factory=dict)
    draw: Callable[[Any], None] | None = None
    size_in: tuple[float, float] = (7.5, 4.5)
    open_loop: Any = None

    @property
    def exit_code(self) -> int:
        """0 where all that was asked is proven, else 1."""
        return 0 if self.verdict is Verdict.PROVEN else 1


def write(outcome: Outcome, name: str, about: str, folder: Path) -> str:
    """Write gains, certificate, picture and explanation into ``folder``, and return the explanation."""
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    if outcome.certificate is not None:
        save_certificate(outcome.certificate, folder / "certificate.json")
        written.append("certificate.json")
        if outcome.gains and outcome.certificate.feasible:
            closed = {} if outcome.open_loop is None else {"gains": outcome.gains["K"], "open_loop": outcome.open_loop}
            save_design(outcome.certificate, folder / "design.json", **closed)
            written.append("design.json")
    if outcome.draw is not None:
        try:
            _picture(outcome, folder / "plot.svg")
            written.append("plot.svg")
        except MissingDependencyError as error:
            written.append(f"(no plot: {error})")
    text = explanation(outcome, name, about)
    (folder / "explanation.md").write_text(text, encoding="utf-8")
    return text + f"\nWritten to {folder}: {', '.join([*written, 'explanation.md'])}\n"


def explanation(outcome: Outcome, name: str, about: str) -> str:
    """Markdown: what was asked, what was found, what it rests on."""
    lines = [f"# {name}", "", *([about.strip(), ""] if about else []), "## Asked", ""]
    lines += [f"- {line}" for line in outcome.asked]
    lines += ["", f"## Found: {outcome.verdict.value}", "", f"- {outcome.reason}"]
    lines += [f"- {line}" for line in outcome.found]
    for label, value in outcome.gains.items():
        lines += ["", f"{label} =", "", *(f"    {row}" for row in matrix_lines(value))]
    if outcome.certificate is not None:
        lines += ["", "## Proof", "", *(f"- {line}" for line in proof_lines(outcome.certificate))]
    return "\n".join(lines) + "\n"


def proof_lines(certificate: Certificate) -> list[str]:
    """What a certificate proves and how, in words."""
    lines = [certificate.claim, f"model {certificate.model.digest[:16]} (SHA-256 of all it says)"]
    if certificate.feasible:
        lines.append("a solution of the inequalities, decided in rational arithmetic on its exact binary values")
        lines += [f"least eigenvalue of {name}: {value:.3g}" for name, value in certificate.margins.items()]
    else:
        lines.append("multipliers in exact arithmetic whose combination of the inequalities no solution can satisfy")
    if certificate.theorem.USES_RATES and not certificate.model.rates_proven:
        lines.append("the bounds on the rates were sampled: this supports the claim and does not prove it")
    if certificate.theorem.USES_RATES:
        lines.append("the conclusion is local: it holds where the rates keep their bounds")
    return lines


def matrix_lines(value: Any) -> list[str]:
    """Rows of a matrix, or of each matrix of a stack."""
    import numpy as np

    array = np.asarray(value, dtype=float)
    if array.ndim == 3:
        return [f"[{k}] {line}" for k, one in enumerate(array) for line in matrix_lines(one)]
    return ["  ".join(f"{entry:14.7g}" for entry in row) for row in np.atleast_2d(array)]


def _picture(outcome: Outcome, path: Path) -> None:
    from robust_core.command_line.plots import figure

    assert outcome.draw is not None
    with figure(*outcome.size_in, path) as drawn:
        outcome.draw(drawn)
