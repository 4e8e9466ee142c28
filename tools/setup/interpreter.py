"""Finds the Python 3.11 the stack runs on, or has uv bring one."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterable, Iterator
from pathlib import Path

from tools.setup.commands import run_logged
from tools.setup.layout import Layout
from tools.setup.problem import SetupProblem
from tools.setup.uv import uv_environment

# pybullet publishes no wheel for a newer one.
VERSION = "3.11"
# Message packages are compiled, so the headers must be there (Debian has them in a package of their own).
PROBE = """
import pathlib, sys, sysconfig
headers = pathlib.Path(sysconfig.get_path("include"), "Python.h")
print("%d.%d" % sys.version_info[:2], headers.exists(), sys.executable)
"""


def find_python(layout: Layout) -> Path:
    """A Python 3.11 with headers: on the path, known to uv, or downloaded by uv.

    Raises:
        SetupProblem: there is none and none could be brought.
    """
    found = first_suitable(candidates(layout))
    if found is not None:
        return found
    try:
        run_logged(
            [layout.uv, "python", "install", VERSION],
            log=layout.logs / "python.log",
            doing=f"Downloading Python {VERSION}",
            environment=uv_environment(),
        )
    except SetupProblem as problem:
        raise SetupProblem(
            f"No Python {VERSION} with headers is installed and none could be downloaded: install it with `sudo "
            f"apt-get install python{VERSION} python{VERSION}-dev` (or connect to the network), then run `make setup` "
            "again."
        ) from problem
    found = first_suitable(managed(layout))
    if found is not None:
        return found
    raise SetupProblem(
        f"uv brought a Python {VERSION} that does not run here: install one with `sudo apt-get install python{VERSION} "
        f"python{VERSION}-dev`, then run `make setup` again."
    )


def candidates(layout: Layout) -> Iterator[Path]:
    """Interpreters worth asking, the system's first."""
    for name in (f"python{VERSION}", "python3"):
        found = shutil.which(name)
        if found:
            yield Path(found)
    yield Path("/usr/bin") / f"python{VERSION}"
    yield from managed(layout)


def managed(layout: Layout) -> Iterator[Path]:
    """What uv knows of, without downloading."""
    done = subprocess.run(
        [str(layout.uv), "python", "find", "--no-project", VERSION],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        env={**uv_environment(), "UV_PYTHON_DOWNLOADS": "never"},
        check=False,
    )
    if done.returncode == 0 and done.stdout.strip():
        yield Path(done.stdout.strip())


def first_suitable(pythons: Iterable[Path]) -> Path | None:
    """The first that will do."""
    return next((found for python in pythons if (found := suitable(python)) is not None), None)


def suitable(python: Path) -> Path | None:
    """The interpreter behind a name, where it has the right version and its headers.

    A name may be a shim that decides by the working directory; what it leads to does not.
    """
    try:
        done = subprocess.run(
            [str(python), "-c", PROBE], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False
        )
    except OSError:
        return None
    version, headers, executable = [*done.stdout.split(maxsplit=2), "", "", ""][:3]
    if done.returncode != 0 or version != VERSION or headers != "True":
        return None
    return Path(executable.strip())
