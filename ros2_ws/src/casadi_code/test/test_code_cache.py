import os
import stat
import subprocess
import sys

import casadi
import pytest

from casadi_code import CompileError, SolverCodeWarning, code_cache, compiled
from casadi_code.code_cache import is_trusted, library_of


@pytest.fixture
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("TRACKED_CACHE_DIR", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    return tmp_path / "solvers"


@pytest.fixture
def square():
    x = casadi.SX.sym("x")
    return casadi.Function("square", [x], [x * x])


def fake_compiler(directory, script):
    path = directory / "fake-cc"
    path.write_text(f"#!/bin/sh\n{script}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path)


def test_library_is_built_once(cache, square):
    library = library_of(square)
    built_ns = library.stat().st_mtime_ns
    assert library_of(square).stat().st_mtime_ns == built_ns
    assert compiled(square)[0](3.0) == 9.0


def test_damaged_library_is_built_anew(cache, square):
    library = library_of(square)
    good = library.read_bytes()
    library.unlink()
    library.write_bytes(good[: len(good) // 2])
    assert not is_trusted(library)
    assert library_of(square).read_bytes() == good


def test_library_without_digest_is_not_trusted(cache, square):
    library = library_of(square)
    digest = library.with_suffix(".sha256")
    digest.unlink()
    assert not is_trusted(library)
    library_of(square)
    assert is_trusted(library)


def test_digest_that_is_no_text_is_not_trusted(cache, square):
    library = library_of(square)
    library.with_suffix(".sha256").write_bytes(b"\xff\xfe")
    assert not is_trusted(library)


def test_other_flags_are_another_library(cache, square, monkeypatch):
    library = library_of(square)
    monkeypatch.setattr(code_cache, "FLAGS", (*code_cache.FLAGS, "-g0"))
    assert library_of(square) != library


def test_without_compiler_the_function_itself_stands_in_and_says_so(cache, square, monkeypatch):
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("CC", raising=False)
    with pytest.warns(SolverCodeWarning, match="no C compiler"):
        function, reason = compiled(square)
    assert function(3.0) == 9.0 and "apt install gcc" in reason


def test_failing_compiler_is_named_with_its_last_words(cache, square, tmp_path, monkeypatch):
    monkeypatch.setenv("CC", fake_compiler(tmp_path, "echo first >&2; echo no space left >&2; exit 3"))
    with pytest.raises(CompileError, match="code 3: no space left"):
        library_of(square)
    assert list(cache.iterdir()) == []


def test_killed_compiler_leaves_nothing(cache, square, tmp_path, monkeypatch):
    monkeypatch.setenv("CC", fake_compiler(tmp_path, "echo half > square.so; kill -9 $$"))
    with pytest.warns(SolverCodeWarning):
        function, reason = compiled(square)
    assert reason and function(3.0) == 9.0
    assert list(cache.iterdir()) == []


def test_killed_set_up_leaves_nothing_that_is_trusted(cache, square, tmp_path):
    compiler = fake_compiler(tmp_path, "echo half > square.so; kill -9 $PPID; sleep 5")
    program = (
        "import casadi; from casadi_code.code_cache import library_of; x = casadi.SX.sym('x');"
        "library_of(casadi.Function('square', [x], [x * x]))"
    )
    environment = {**os.environ, "CC": compiler, "PYTHONPATH": os.pathsep.join(sys.path)}
    assert subprocess.run([sys.executable, "-c", program], env=environment, check=False).returncode != 0
    assert not any(is_trusted(path) for path in cache.glob("*.so"))
    assert compiled(square)[0](4.0) == 16.0


def test_unusable_cache_directory_falls_back(tmp_path, square, monkeypatch):
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("TRACKED_CACHE_DIR", str(blocked))
    with pytest.warns(SolverCodeWarning):
        function, _ = compiled(square)
    assert function(3.0) == 9.0


def test_library_that_cannot_be_loaded_falls_back(cache, square, tmp_path, monkeypatch):
    monkeypatch.setenv("CC", fake_compiler(tmp_path, "echo not a library > square.so"))
    with pytest.warns(SolverCodeWarning):
        function, _ = compiled(square)
    assert function(3.0) == 9.0


def test_default_cache_lies_in_the_home_directory(monkeypatch, tmp_path):
    monkeypatch.delenv("TRACKED_CACHE_DIR", raising=False)
    monkeypatch.setenv("HOME", str(tmp_path))
    assert code_cache.cache_directory() == tmp_path / ".cache" / "tracked_stack" / "solvers"
