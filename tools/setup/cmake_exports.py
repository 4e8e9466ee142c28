"""Mends the CMake exports of the ROS wheels: they carry include paths of the machine that built them."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

from tools.setup.commands import clean_environment
from tools.setup.layout import Layout
from tools.setup.problem import SetupProblem

# An entry of INTERFACE_INCLUDE_DIRECTORIES that ends in Python's or numpy's include directory, whoever wrote it.
PYTHON_INCLUDE = re.compile(r'[^";\s]*/include/python3\.\d+(?=[";])')
NUMPY_INCLUDE = re.compile(r'[^";\s]*/numpy/_?core/include(?=[";])')
ASK = "import sysconfig, numpy; print(sysconfig.get_path('include')); print(numpy.get_include())"


def mended(text: str, python_include: str, numpy_include: str) -> str:
    """The text of an export file with this environment's own include directories."""
    text = NUMPY_INCLUDE.sub(lambda _: numpy_include, text)
    return PYTHON_INCLUDE.sub(lambda _: python_include, text)


def mend_cmake_exports(layout: Layout) -> int:
    """Rewrite every export file that needs it; returns how many did.

    Raises:
        SetupProblem: the environment's Python or numpy does not start.
    """
    asked = subprocess.run(
        [str(layout.python), "-c", ASK],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        env=clean_environment(),
        check=False,
    )
    if asked.returncode != 0:
        raise SetupProblem(
            "numpy does not start in the new environment: remove it with `rm -rf .venv`, then run `make setup` again.\n"
            + asked.stderr[-1000:]
        )
    python_include, numpy_include = asked.stdout.split("\n")[:2]
    changed = 0
    for export in sorted((layout.venv / "share").glob("*/cmake/*Export.cmake")):
        before = export.read_text()
        after = mended(before, python_include, numpy_include)
        if after != before:
            replace_file(export, after)
            changed += 1
    return changed


def replace_file(path: Path, text: str) -> None:
    """Put a new file in the place of the old one.

    uv links installed files to its cache: writing into the old file would change the cache, and with it every other
    environment of the machine.
    """
    beside = path.with_name(path.name + ".new")
    beside.write_text(text)
    beside.replace(path)
