"""Parameters of the peers as `make tune` found them."""

from importlib import resources
from pathlib import Path

import yaml

TUNED_FILE = Path(str(resources.files("tracked_lab") / "data" / "peers.yaml"))


def tuned_parameters(name: str) -> dict[str, float]:
    """Parameters of a peer for `tracked_lab.conditions.Conditions`; empty for those that have none to tune."""
    found: dict[str, dict[str, float]] = yaml.safe_load(TUNED_FILE.read_text())
    return found.get(name, {})
