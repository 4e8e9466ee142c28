"""What a machine must bring, checked before anything is touched."""

from __future__ import annotations

import os
import shutil
import tempfile
from pathlib import Path

from tools.setup.layout import Layout
from tools.setup.problem import SetupProblem

NEEDED_BYTES = 4_000_000_000

# Program, alternatives that serve as well, Debian package.
PROGRAMS = (
    (("cc", "gcc", "clang"), "A C compiler", "build-essential"),
    (("c++", "g++", "clang++"), "A C++ compiler", "build-essential"),
    (("make",), "make", "make"),
    (("cmake",), "CMake", "cmake"),
)


def check_writable(layout: Layout) -> None:
    """The tree takes new files."""
    try:
        with tempfile.TemporaryFile(dir=layout.root) as probe:
            # A full disk accepts the name of a file and refuses its content.
            probe.write(b"\0" * 65536)
            probe.flush()
            os.fsync(probe.fileno())
    except OSError as error:
        if error.errno in (28, 122):
            raise SetupProblem(disk_full(layout.root, shutil.disk_usage(layout.root).free)) from error
        raise SetupProblem(
            f"The checkout {layout.root} is not writable ({error.strerror}): move it with `cp -r {layout.root} "
            '~/tracked_stack` or take it over with `sudo chown -R "$USER" .`, then run `make setup` again.'
        ) from error


def disk_full(where: Path, free_bytes: float) -> str:
    """The sentence for too little space."""
    return (
        f"The set-up needs {NEEDED_BYTES / 1e9:.0f} GB and only {free_bytes / 1e9:.1f} GB are free at {where}: free "
        f"some space (see `df -h {where}`), then run `make setup` again."
    )


def check_disk(layout: Layout) -> None:
    """Room for the virtual environment and the build, asked only where there is no environment yet."""
    if layout.python.exists():
        return
    free_bytes = shutil.disk_usage(layout.root).free
    if free_bytes < NEEDED_BYTES:
        raise SetupProblem(disk_full(layout.root, free_bytes))


def check_programs() -> None:
    """Compilers, make and CMake are on the path."""
    for names, title, package in PROGRAMS:
        if not any(shutil.which(name) for name in names):
            raise SetupProblem(
                f"{title} is missing ({' or '.join(names)}): install it with `sudo apt-get install {package}`, then "
                "run `make setup` again."
            )


def check_machine(layout: Layout) -> None:
    """Every check, the cheapest first.

    Raises:
        SetupProblem: the first thing that is missing, with the command that mends it.
    """
    check_writable(layout)
    check_disk(layout)
    check_programs()
