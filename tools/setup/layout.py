"""Where the set-up puts things in a working tree."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Layout:
    """Paths of a working tree, all below its root.

    Everything the set-up makes lives in ``.venv``, ``.cache`` and ``ros2_ws/{build,install,log}``: deleting these
    (``make clean``) leaves the checkout as git made it.
    """

    root: Path

    @property
    def venv(self) -> Path:
        """The virtual environment with ROS, the numeric packages and the tools."""
        return self.root / ".venv"

    @property
    def python(self) -> Path:
        """The interpreter everything runs on."""
        return self.venv / "bin" / "python"

    @property
    def cache(self) -> Path:
        """Caches and logs of the set-up."""
        return self.root / ".cache"

    @property
    def logs(self) -> Path:
        """Output of every external command, one file per step."""
        return self.cache / "setup"

    @property
    def uv(self) -> Path:
        """The pinned uv."""
        return self.cache / "uv" / "bin" / "uv"

    @property
    def workspace(self) -> Path:
        """The colcon workspace."""
        return self.root / "ros2_ws"

    @property
    def requirements(self) -> Path:
        """Locked requirements."""
        return self.root / "requirements"

    @property
    def tf2_msgs(self) -> Path:
        """Source of the one interface package that no wheel carries."""
        return self.root / "tools" / "tf2_msgs"
