"""Runs external commands with their output in a log, and says in one sentence why one failed."""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

from tools.setup.problem import SetupProblem

# Set by a sourced ROS installation or another virtual environment: they would mix foreign packages into ours.
FOREIGN_VARIABLES = (
    "AMENT_PREFIX_PATH",
    "CMAKE_PREFIX_PATH",
    "COLCON_PREFIX_PATH",
    "PYTHONHOME",
    "PYTHONPATH",
    "VIRTUAL_ENV",
)
# The wheels' start-up hook sets these for its own environment only.
BOOTSTRAP_FLAG = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"

# Causes a user can mend, by what tools print about them.
CAUSES = (
    (
        re.compile(r"no space left on device|os error 28|errno 28|disk quota exceeded", re.I),
        "The disk is full: free at least 4 GB (see `df -h .`), then run `make setup` again.",
    ),
    (
        re.compile(r"read-only file system|os error 30|errno 30", re.I),
        "The file system is read-only: move the checkout to a writable disk, for example with "
        "`cp -r . ~/tracked_stack`, then run `make setup` there.",
    ),
    (
        re.compile(
            r"dns error|name resolution|name or service not known|error sending request|connection (refused|reset)"
            r"|network is (unreachable|unavailable)|connect timeout|connection timed out|tunnel error"
            r"|newconnectionerror|failed to establish a new connection|retries exceeded|failed to (fetch|download)"
            r"|\(from versions: none\)",
            re.I,
        ),
        "The package index cannot be reached, and the first set-up needs it: connect this machine to the network "
        "(or name a mirror with `export UV_DEFAULT_INDEX=... PIP_INDEX_URL=...`), then run `make setup` again.",
    ),
    (
        re.compile(r"hash mismatch|hashes? .*do(es)? not match|do not match the hashes", re.I),
        "A downloaded package differs from the locked one: clear the cache with `rm -rf .cache` and "
        "`uv cache clean`, then run `make setup` again.",
    ),
)


def clean_environment(extra: Mapping[str, str] | None = None) -> dict[str, str]:
    """The caller's environment without what other ROS installations and virtual environments put there."""
    environment = {name: value for name, value in os.environ.items() if name not in FOREIGN_VARIABLES}
    if environment.pop(BOOTSTRAP_FLAG, None):
        environment.pop("LD_LIBRARY_PATH", None)
    environment.update(extra or {})
    return environment


def explain(output: str) -> str | None:
    """The sentence for a failure whose cause the output shows, or None."""
    for pattern, sentence in CAUSES:
        if pattern.search(output):
            return sentence
    return None


def run_logged(
    command: Sequence[str | Path],
    *,
    log: Path,
    doing: str,
    environment: Mapping[str, str] | None = None,
    directory: Path | None = None,
    show: re.Pattern[str] | None = None,
) -> None:
    """Run a command, all output to ``log`` (appended), lines matching ``show`` also to the terminal.

    Raises:
        SetupProblem: the command cannot start or fails; with the cause where the output shows a known one, otherwise
            with the last lines of the log.
    """
    log.parent.mkdir(parents=True, exist_ok=True)
    lines: list[str] = []
    with log.open("a") as sink:
        sink.write("$ " + " ".join(str(part) for part in command) + "\n")
        sink.flush()
        try:
            process = subprocess.Popen(
                [str(part) for part in command],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                errors="replace",
                env=dict(environment) if environment is not None else clean_environment(),
                cwd=directory,
            )
        except OSError as error:
            raise SetupProblem(f"{doing} could not start ({error}): see {log}, then run `make setup` again.") from error
        with process:
            assert process.stdout is not None
            for line in process.stdout:
                sink.write(line)
                lines.append(line)
                if show is not None and show.search(line):
                    print("      " + line.strip(), flush=True)
    if process.returncode != 0:
        output = "".join(lines)
        known = explain(output)
        if known is not None:
            raise SetupProblem(known)
        tail = "".join(lines[-15:])
        raise SetupProblem(
            f"{doing} failed: read the end of {log}, mend what it names, then run `make setup` again.\n{tail}"
        )
