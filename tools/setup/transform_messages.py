"""tf2_msgs: the one message package that the stack needs and no wheel carries, built into the environment."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path

from tools.setup.commands import clean_environment, run_logged
from tools.setup.layout import Layout
from tools.setup.problem import SetupProblem

# Hash of the official definition: with it our TF is everybody's TF.
OFFICIAL_TYPE_HASH = "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"


def build_environment(layout: Layout) -> dict[str, str]:
    """Environment in which CMake and colcon find the wheels' packages and tools."""
    return clean_environment(
        {
            "AMENT_PREFIX_PATH": str(layout.venv),
            "CMAKE_PREFIX_PATH": str(layout.venv),
            "VIRTUAL_ENV": str(layout.venv),
            "PATH": os.pathsep.join([str(layout.venv / "bin"), os.environ.get("PATH", "")]),
            # Without this colcon adds a load limit, which on a busy machine leaves one compiler running at a time.
            "MAKEFLAGS": f"-j{processors()}",
        }
    )


def processors() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0))


def install_tf2_msgs(layout: Layout) -> None:
    """Build tf2_msgs with CMake straight into ``.venv``.

    Raises:
        SetupProblem: the build fails, or what it made is not the official type.
    """
    build = layout.cache / "tf2_msgs"
    shutil.rmtree(build, ignore_errors=True)
    environment = build_environment(layout)
    log = layout.logs / "tf2_msgs.log"
    configure: list[str | Path] = ["cmake", "-S", layout.tf2_msgs, "-B", build, f"-DCMAKE_INSTALL_PREFIX={layout.venv}"]
    configure += ["-DCMAKE_BUILD_TYPE=Release", "-DBUILD_TESTING=OFF"]
    configure += [f"-DPython3_EXECUTABLE={layout.python}", "-DPython3_FIND_VIRTUALENV=ONLY"]
    compile_it: list[str | Path] = ["cmake", "--build", build, "--parallel", str(processors())]
    install: list[str | Path] = ["cmake", "--install", build]
    for command in (configure, compile_it, install):
        run_logged(command, log=log, doing="Building tf2_msgs", environment=environment)
    check_type_hash(layout)
    shutil.rmtree(build, ignore_errors=True)


def check_type_hash(layout: Layout) -> None:
    """The installed TFMessage is the one every other ROS 2 Jazzy speaks."""
    description = json.loads((layout.venv / "share" / "tf2_msgs" / "msg" / "TFMessage.json").read_text())
    found = {entry["type_name"]: entry["hash_string"] for entry in description["type_hashes"]}
    if found.get("tf2_msgs/msg/TFMessage") != OFFICIAL_TYPE_HASH:
        raise SetupProblem(
            "tools/tf2_msgs no longer defines the official TFMessage: restore it with `git checkout tools/tf2_msgs`, "
            "then run `make setup` again."
        )
