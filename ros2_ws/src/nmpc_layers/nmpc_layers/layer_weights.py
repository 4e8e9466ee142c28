"""Tuned weights of the layers, read from a checked YAML file."""

from importlib import resources
from pathlib import Path

from nmpc_layers.certified_terminal import TerminalSource
from nmpc_layers.solver import Weights
from tracked_types.checked_yaml import CheckedModel, load_checked_yaml

METHODS = ("improved", "thesis")
PACKAGED = "weights.yaml"


class MethodWeights(CheckedModel):
    """Weights of one method: the upper layer alone, and both layers together.

    upper_terminal: a certified terminal weight for the upper layer that has a lower one, if there is one.
    """

    single: Weights
    upper: Weights
    lower: Weights
    upper_terminal: TerminalSource | None = None


class LayerWeights(CheckedModel):
    """Weights of every method."""

    improved: MethodWeights
    thesis: MethodWeights

    def of(self, method: str) -> MethodWeights:
        """Weights of the method of this name.

        Raises
        ------
        ValueError: if there is no such method.
        """
        if method == "improved":
            return self.improved
        if method == "thesis":
            return self.thesis
        raise ValueError(f"method must be one of {', '.join(METHODS)}; got {method!r}")


def load_weights(path: Path | str | None = None) -> LayerWeights:
    """Read and check a weights file; without a path (or with an empty one), the packaged weights.yaml.

    Raises
    ------
    CheckedFileError: if the file is missing, is not YAML, or a key is missing, unknown or out of range.
    """
    if path:
        return load_checked_yaml(LayerWeights, Path(path))
    return load_checked_yaml(LayerWeights, weights_folder() / PACKAGED, PACKAGED)


def weights_folder(path: Path | str | None = None) -> Path:
    """Folder of a weights file, in which the files that it names are; without a path, that of the packaged one."""
    return Path(path).parent if path else Path(str(resources.files("nmpc_layers") / "data"))
