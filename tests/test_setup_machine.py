"""What the set-up says about a machine that lacks something: one sentence, a command, and no trace left."""

import errno
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from tests.support.node_process import ROOT
from tools.setup import checks, interpreter
from tools.setup.layout import Layout
from tools.setup.problem import SetupProblem

TOOLBOX = ("bash", "python3", "make", "cmake", "cc", "c++", "env", "cat", "rm")
NOBODY_LISTENS = "http://127.0.0.1:9/simple"


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """The part of a fresh checkout that the set-up reads."""
    for name in ("Makefile", "run"):
        shutil.copy(ROOT / name, tmp_path)
    for name in ("tools", "requirements"):
        shutil.copytree(ROOT / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    (tmp_path / "ros2_ws" / "src").mkdir(parents=True)
    return tmp_path


def make_setup(tree: Path, *, without: str = "", **changes: str) -> subprocess.CompletedProcess[str]:
    """``make setup`` where only a few programs are installed."""
    programs = tree / "programs"
    programs.mkdir()
    for name in TOOLBOX:
        if name != without:
            (programs / name).symlink_to(shutil.which(name) or name)
    environment = {
        name: value for name, value in os.environ.items() if not name.startswith(("PIP_", "UV_", "MAKE", "LD_", "_ROS"))
    }
    environment.update(PATH=str(programs), PIP_CONFIG_FILE=os.devnull, PYENV_VERSION="system")
    environment.update(changes)
    return subprocess.run(
        [shutil.which("make") or "make", "setup"],
        cwd=tree,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=90,
    )


@pytest.mark.parametrize(
    ("missing", "package"), [("cc", "build-essential"), ("c++", "build-essential"), ("cmake", "cmake")]
)
def test_a_missing_build_tool_is_named_with_the_command_that_brings_it(tree, missing, package):
    done = make_setup(tree, without=missing)
    assert done.returncode != 0
    assert f"sudo apt-get install {package}" in done.stderr
    assert not (tree / ".venv").exists()


def test_a_missing_python_is_named_with_the_command_that_brings_it(tree):
    done = make_setup(tree, without="python3")
    assert done.returncode != 0
    assert "sudo apt-get install python3" in done.stderr


def test_a_first_set_up_without_network_says_so_and_leaves_no_proof(tree):
    done = make_setup(tree, PIP_INDEX_URL=NOBODY_LISTENS, PIP_RETRIES="0", PIP_NO_CACHE_DIR="1")
    assert done.returncode != 0
    assert "package index cannot be reached" in done.stderr
    assert "Traceback" not in done.stderr
    assert not list(tree.rglob("*stamp"))


def test_starting_before_the_set_up_names_the_command(tree):
    done = subprocess.run([str(tree / "run"), "node_kit", "x"], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "make setup" in done.stderr


def refuse(number: int) -> Any:
    """Something that opens a file and fails as the system would."""

    def opened(*_: Any, **__: Any) -> Any:
        raise OSError(number, os.strerror(number))

    return opened


def test_a_read_only_checkout_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(checks.tempfile, "TemporaryFile", refuse(errno.EROFS))
    with pytest.raises(SetupProblem, match=r"not writable \(Read-only file system\).*`cp -r"):
        checks.check_writable(Layout(tmp_path))


def test_a_disk_that_is_full_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(checks.tempfile, "TemporaryFile", refuse(errno.ENOSPC))
    with pytest.raises(SetupProblem, match=r"needs 4 GB .*free some space"):
        checks.check_writable(Layout(tmp_path))


def test_a_disk_that_will_be_full_is_refused_before_anything_is_written(tmp_path, monkeypatch):
    usage = shutil.disk_usage(tmp_path)
    monkeypatch.setattr(checks.shutil, "disk_usage", lambda _: usage._replace(free=10**9))
    with pytest.raises(SetupProblem, match=r"only 1\.0 GB are free"):
        checks.check_machine(Layout(tmp_path))
    assert not list(tmp_path.iterdir())


def test_an_installed_environment_needs_no_further_room(tmp_path, monkeypatch):
    layout = Layout(tmp_path)
    layout.python.parent.mkdir(parents=True)
    layout.python.touch()
    usage = shutil.disk_usage(tmp_path)
    monkeypatch.setattr(checks.shutil, "disk_usage", lambda _: usage._replace(free=10**9))
    checks.check_disk(layout)


def program(path: Path, text: str) -> Path:
    """A shell script."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("#!/bin/sh\n" + text + "\n")
    path.chmod(0o755)
    return path


def test_a_python_of_the_wrong_version_or_without_headers_will_not_do(tmp_path):
    assert interpreter.suitable(program(tmp_path / "newer", "echo 3.12 True /usr/bin/python3.12")) is None
    assert interpreter.suitable(program(tmp_path / "bare", "echo 3.11 False /usr/bin/python3.11")) is None
    assert interpreter.suitable(program(tmp_path / "broken", "exit 127")) is None
    assert interpreter.suitable(tmp_path / "absent") is None


def test_a_shim_is_followed_to_the_interpreter_behind_it(tmp_path):
    shim = program(tmp_path / "python3.11", "echo 3.11 True /opt/a directory/python3.11")
    assert interpreter.suitable(shim) == Path("/opt/a directory/python3.11")


def test_no_python_and_no_download_names_the_command(tmp_path, monkeypatch):
    layout = Layout(tmp_path)
    program(layout.uv, "exit 1")
    monkeypatch.setattr(interpreter, "candidates", lambda _: iter(()))
    with pytest.raises(SetupProblem, match=r"No Python 3\.11 .*sudo apt-get install python3\.11 python3\.11-dev"):
        interpreter.find_python(layout)
