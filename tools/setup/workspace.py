"""Builds the packages of ``ros2_ws/src`` with colcon, as on a robot, and only those that changed."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from pathlib import Path

from tools.setup.commands import run_logged
from tools.setup.layout import Layout
from tools.setup.stamp import Stamp, fingerprint
from tools.setup.transform_messages import build_environment

# Contents that colcon reads while it builds. Everything else is linked into the installation and needs no build when
# edited, only when a file comes or goes.
BUILD_FILES = ("package.xml", "setup.py", "setup.cfg", "CMakeLists.txt")
INTERFACE_SUFFIXES = (".msg", ".srv", ".action")
IGNORED_PARTS = ("__pycache__", "test", ".pytest_cache", ".hypothesis", ".mypy_cache", ".ruff_cache")
PROGRESS = re.compile(r"^(Finished|Failed|Aborted)\s+<<<")


def packages(layout: Layout) -> dict[str, Path]:
    """Source directories by package name."""
    return {file.parent.name: file.parent for file in sorted((layout.workspace / "src").glob("*/package.xml"))}


def relevant_files(package: Path) -> Iterator[Path]:
    """Files of a package that its installation consists of."""
    for file in sorted(package.rglob("*")):
        parts = file.relative_to(package).parts
        if file.is_file() and not any(part in IGNORED_PARTS or part.endswith(".egg-info") for part in parts):
            yield file


def package_fingerprint(package: Path, base: str) -> str:
    """Changes exactly when colcon has to build the package again."""
    files = list(relevant_files(package))
    names = [str(file.relative_to(package)) for file in files if file.suffix != ".py"]
    read = [file for file in files if file.name in BUILD_FILES or file.suffix in INTERFACE_SUFFIXES]
    return fingerprint([base, *names], read)


def stamp_of(layout: Layout, name: str) -> Stamp:
    """Proof that a package is installed; inside its installation."""
    return Stamp(layout.workspace / "install" / name / ".setup_stamp")


def stale_packages(layout: Layout, base: str) -> list[str]:
    """Packages to build, in alphabetical order; ``base`` stands for everything below the workspace."""
    return [
        name
        for name, source in packages(layout).items()
        if stamp_of(layout, name).read() != package_fingerprint(source, base)
    ]


def orphans(layout: Layout) -> list[Path]:
    """Build and install directories of packages whose source is gone."""
    known = packages(layout)
    return [
        directory
        for area in ("build", "install")
        for directory in sorted((layout.workspace / area).glob("*/"))
        if directory.name not in known
    ]


def build_workspace(layout: Layout, base: str) -> None:
    """Build what is stale, remove what is orphaned."""
    for directory in orphans(layout):
        shutil.rmtree(directory)
    stale = stale_packages(layout, base)
    if not stale:
        return
    sources = packages(layout)
    # Taken before the build: an edit made meanwhile is built the next time.
    proofs = {name: package_fingerprint(sources[name], base) for name in stale}
    for name in stale:
        stamp_of(layout, name).withdraw()
    command = ["colcon", "build", "--symlink-install", "--packages-select", *stale]
    command += ["--cmake-args", "-DCMAKE_BUILD_TYPE=Release", "-DBUILD_TESTING=OFF"]
    command += [f"-DPython3_EXECUTABLE={layout.python}", "-DPython3_FIND_VIRTUALENV=ONLY"]
    run_logged(
        command,
        log=layout.logs / "workspace.log",
        doing="Building the workspace",
        environment=build_environment(layout),
        directory=layout.workspace,
        show=PROGRESS,
    )
    for name, proof in proofs.items():
        stamp_of(layout, name).write(proof)
