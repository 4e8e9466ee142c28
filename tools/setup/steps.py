"""The steps of the set-up, each with the inputs that make it stale."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from tools.setup import caches, transform_messages, uv, wheels, workspace
from tools.setup.layout import Layout
from tools.setup.stamp import Stamp, fingerprint

HERE = Path(__file__).parent


@dataclass(frozen=True)
class Step:
    """One product: what it is called, what proves it, how to make it."""

    title: str
    is_current: Callable[[], bool]
    make: Callable[[], None]


def stamped(title: str, stamp: Stamp, proof: Callable[[], str], make: Callable[[], None]) -> Step:
    """A step proved by one stamp."""

    def run() -> None:
        # Taken before: an edit made meanwhile is noticed the next time.
        value = proof()
        stamp.withdraw()
        make()
        stamp.write(value)

    return Step(title, lambda: stamp.read() == proof(), run)


def setup_steps(layout: Layout) -> list[Step]:
    """All steps in order. Each proof contains the one below it, so a changed lock file renews everything above."""

    def uv_proof() -> str:
        # The root is part of it: scripts of an environment name their interpreter by its full path.
        return fingerprint([str(layout.root)], [layout.requirements / "uv.txt"])

    def wheels_proof() -> str:
        rules = [HERE / "wheels.py", HERE / "cmake_exports.py", HERE / "interpreter.py"]
        return fingerprint([str(layout.root)], [layout.requirements / "dev.txt", *rules])

    def tf2_proof() -> str:
        sources = sorted(file for file in layout.tf2_msgs.rglob("*") if file.is_file())
        return fingerprint([wheels_proof()], [*sources, HERE / "transform_messages.py"])

    def workspace_base() -> str:
        return fingerprint([tf2_proof()], [HERE / "workspace.py"])

    def caches_proof() -> str:
        return fingerprint([wheels_proof()], [*caches.inputs(layout), HERE / "caches.py"])

    return [
        stamped("uv", Stamp(layout.cache / "uv" / ".stamp"), uv_proof, lambda: uv.install_uv(layout)),
        stamped(
            "ROS 2 and Python packages",
            Stamp(layout.venv / ".setup_stamp"),
            wheels_proof,
            lambda: wheels.install_wheels(layout),
        ),
        stamped(
            "tf2_msgs",
            Stamp(layout.venv / "share" / "tf2_msgs" / ".setup_stamp"),
            tf2_proof,
            lambda: transform_messages.install_tf2_msgs(layout),
        ),
        Step(
            "workspace (colcon)",
            lambda: not workspace.stale_packages(layout, workspace_base()) and not workspace.orphans(layout),
            lambda: workspace.build_workspace(layout, workspace_base()),
        ),
        stamped(
            "solver code and compiled kernels",
            Stamp(layout.cache / "setup" / "caches.stamp"),
            caches_proof,
            lambda: caches.fill_caches(layout),
        ),
    ]
