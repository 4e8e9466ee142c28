"""Generates solver code and compiles the numeric kernels, so that the first run does not wait for them."""

from __future__ import annotations

import re
from pathlib import Path

from tools.setup.commands import clean_environment, run_logged
from tools.setup.layout import Layout

# Modules whose ``python -m`` fills a cache; a package that is not there yet has nothing to fill.
WARM_UPS = ("nmpc_layers.warm_up", "sim_bridge.warm_up")
DEPENDENCY = re.compile(r"<(?:exec_)?depend>\s*(\w+)\s*<")


def warm_up_files(layout: Layout) -> list[Path]:
    """The modules that exist in this tree."""
    source = layout.workspace / "src"
    files = []
    for module in WARM_UPS:
        package, name = module.split(".")
        files.append(source / package / package / f"{name}.py")
    return [file for file in files if file.exists()]


def inputs(layout: Layout) -> list[Path]:
    """Every file a cache may depend on: modules and data of the packages that fill one, and of what these stand on."""
    source = layout.workspace / "src"
    waiting = [file.parent.name for file in warm_up_files(layout)]
    packages: set[str] = set()
    while waiting:
        package = waiting.pop()
        if package not in packages and (source / package).is_dir():
            packages.add(package)
            waiting += DEPENDENCY.findall((source / package / "package.xml").read_text())
    # Nodes only translate; nothing of theirs is compiled.
    return [
        file
        for package in sorted(packages)
        for file in sorted((source / package / package).rglob("*"))
        if file.suffix in (".py", ".yaml") and "nodes" not in file.parts
    ]


def fill_caches(layout: Layout) -> None:
    """Run each warm-up through ``./run``, the environment the nodes have."""
    for file in warm_up_files(layout):
        module = f"{file.parent.name}.{file.stem}"
        run_logged(
            [layout.root / "run", "python", "-m", module],
            log=layout.logs / "caches.log",
            doing=f"Filling the caches of {file.parent.name}",
            environment=clean_environment(),
            directory=layout.root,
        )
