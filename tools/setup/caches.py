"""Generates solver code and compiles the numeric kernels, so that the first run does not wait for them."""

from __future__ import annotations

from pathlib import Path

from tools.setup.commands import clean_environment, run_logged
from tools.setup.layout import Layout

# Modules whose ``python -m`` fills a cache; a package that is not there yet has nothing to fill.
WARM_UPS = ("nmpc_layers.warm_up", "sim_bridge.warm_up")


def warm_up_files(layout: Layout) -> list[Path]:
    """The modules that exist in this tree."""
    source = layout.workspace / "src"
    files = []
    for module in WARM_UPS:
        package, name = module.split(".")
        files.append(source / package / package / f"{name}.py")
    return [file for file in files if file.exists()]


def inputs(layout: Layout) -> list[Path]:
    """Every file a cache may depend on: the algorithms and their data."""
    source = layout.workspace / "src"
    modules = sorted([*source.glob("*/*/**/*.py"), *source.glob("*/*/**/*.yaml")])
    return [file for file in modules if "test" not in file.relative_to(source).parts and "nodes" not in file.parts]


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
