"""What a specification asks, in words."""

from typing import Any

from robust_core.command_line.fields import Fields, shown
from robust_core.command_line.spec import COMMAND_OF, Spec

_MEANING = {
    "stabilise": "vertex gains u = sum_j sigma_j K_j x, rounded first and proven afterwards",
    "filter": "a filter x_f' = A x_f + B y that estimates z, rounded first and proven afterwards",
    "observer": "an observer for one Lipschitz term whose residual shows faults",
    "certify": "a proof for what is given",
    "map": "a verdict of every theorem at every point, each proven in exact arithmetic",
}


def asking(spec: Spec) -> str:
    """Markdown; reads the specification and solves nothing."""
    lines = [f"# {spec.name}", ""]
    lines += [spec.about.strip(), ""] if spec.about else []
    lines += [f"Asks for {_MEANING[spec.task]}.", "", "## System", "", *_system(spec.system), "", "## Asked", ""]
    lines += [f"- {name}: {shown(value)}" for name, value in spec.asked.content.items()] or ["- the defaults"]
    lines += ["", f"Answered by: robust_core {COMMAND_OF[spec.task]}"]
    return "\n".join(lines)


def _system(system: Fields) -> list[str]:
    content: dict[str, Any] = system.content
    if system.has("states"):
        lines = [f"- formulas of {shown(content['states'])} over the box {shown(content.get('box'))}"]
        if system.has("terms"):
            lines.append(f"- weights and vertices follow from the terms {shown(content['terms'])}")
        rates = content.get("rates", "enclosed")
        proves = "a proof" if rates == "enclosed" else "no proof"
        return [*lines, f"- rates of the weights over the whole box: {rates} ({proves})"]
    return [f"- {name}: {shown(value)}" for name, value in content.items()]
