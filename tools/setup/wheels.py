"""The virtual environment: exactly the locked wheels."""

from __future__ import annotations

import shutil
from pathlib import Path

from tools.setup.cmake_exports import mend_cmake_exports
from tools.setup.commands import run_logged
from tools.setup.interpreter import find_python
from tools.setup.layout import Layout
from tools.setup.uv import uv_environment


def install_wheels(layout: Layout) -> None:
    """Make ``.venv`` anew, holding exactly ``requirements/dev.txt``.

    Always anew, which takes seconds from uv's cache. A package cut short by an interruption looks complete to every
    installer; and the ROS wheels carry metadata under a second name, which a sync of a filled environment takes for
    packages to remove, and their files with them.
    """
    python = find_python(layout)
    shutil.rmtree(layout.venv, ignore_errors=True)
    locked = layout.requirements / "dev.txt"
    create: list[str | Path] = [layout.uv, "venv", "--no-project", "--python", python, layout.venv]
    fill: list[str | Path] = [layout.uv, "pip", "sync", "--require-hashes", "--python", layout.python, locked]
    # The few packages without a wheel are built with a locked build backend too.
    fill += ["--build-constraints", locked]
    for command in (create, fill):
        run_logged(
            command,
            log=layout.logs / "wheels.log",
            doing="Installing the wheels",
            environment=uv_environment(),
        )
    mend_cmake_exports(layout)
