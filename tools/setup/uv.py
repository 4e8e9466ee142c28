"""Brings the pinned uv into the tree, from pip itself, hash-checked."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from tools.setup.commands import clean_environment, run_logged
from tools.setup.layout import Layout
from tools.setup.problem import SetupProblem


def uv_environment() -> dict[str, str]:
    """Environment of uv: a machine configured for pip alone (mirror, certificate) serves uv too."""
    environment = clean_environment({"UV_NO_PROGRESS": "1", "UV_PYTHON_DOWNLOADS": "automatic"})
    for ours, of_pip in (("UV_DEFAULT_INDEX", "PIP_INDEX_URL"), ("SSL_CERT_FILE", "PIP_CERT")):
        if of_pip in os.environ:
            environment.setdefault(ours, os.environ[of_pip])
    return environment


def python_with_pip(layout: Layout) -> Path:
    """An interpreter that has pip: the one running, or a small environment made from it.

    Raises:
        SetupProblem: neither pip nor the venv module's own copy of it is there (Debian packages both apart).
    """
    if run_quietly(Path(sys.executable), "-m", "pip", "--version"):
        return Path(sys.executable)
    helper = layout.cache / "pip"
    if run_quietly(Path(sys.executable), "-m", "venv", "--clear", str(helper)):
        return helper / "bin" / "python"
    raise SetupProblem(
        "This Python has neither pip nor ensurepip: install them with `sudo apt-get install python3-venv python3-pip`, "
        "then run `make setup` again."
    )


def run_quietly(python: Path, *arguments: str) -> bool:
    """True where the command succeeds."""
    done = subprocess.run(
        [str(python), *arguments],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=clean_environment(),
        check=False,
    )
    return done.returncode == 0


def install_uv(layout: Layout) -> None:
    """Install ``requirements/uv.txt`` into ``.cache/uv``."""
    python = python_with_pip(layout)
    command: list[str | Path] = [python, "-m", "pip", "install", "--quiet", "--upgrade", "--no-deps"]
    command += ["--only-binary", ":all:", "--require-hashes"]
    command += ["--target", layout.uv.parent.parent, "-r", layout.requirements / "uv.txt"]
    run_logged(
        command,
        log=layout.logs / "uv.log",
        doing="Installing uv",
    )
