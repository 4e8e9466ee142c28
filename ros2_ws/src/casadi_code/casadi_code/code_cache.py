"""CasADi functions as machine code: generated C, the system's compiler, and a cache keyed by content.

A library in the cache is trusted only with a digest file beside it that matches its bytes. The digest is
written last and both arrive by rename, so that a compile that was killed, a full disk or a damaged file
leads to a new build and never to a half-written library.
"""

import hashlib
import os
import platform
import shutil
import subprocess
import tempfile
import warnings
from pathlib import Path
from typing import Any

import casadi

CACHE_VARIABLE = "TRACKED_CACHE_DIR"
COMPILERS = ("cc", "gcc", "clang")
FLAGS = ("-O3", "-fPIC", "-shared", "-fno-math-errno", "-w")
COMPILE_LIMIT_S = 120.0


class SolverCodeWarning(UserWarning):
    """Solver code could not be compiled; the interpreter stands in, correct but about six times slower."""


class CompileError(RuntimeError):
    """Why there is no machine code, in words."""


def cache_directory() -> Path:
    """``$TRACKED_CACHE_DIR/solvers``, by default below ``~/.cache/tracked_stack``."""
    configured = os.environ.get(CACHE_VARIABLE)
    base = Path(configured) if configured else Path.home() / ".cache" / "tracked_stack"
    return base / "solvers"


def compiled(function: Any) -> tuple[Any, str]:
    """``function`` as machine code where possible.

    Returns the function to call and the reason why it is not compiled ("" if it is). The reason is also
    given as a `SolverCodeWarning`.
    """
    try:
        return casadi.external(function.name(), str(library_of(function))), ""
    except (CompileError, OSError, RuntimeError) as error:
        reason = f"solver {function.name()} runs in the CasADi interpreter: {error}"
        warnings.warn(reason, SolverCodeWarning, stacklevel=2)
        return function, reason


def library_of(function: Any) -> Path:
    """Shared library with the code of ``function``, from the cache or built into it.

    Raises
    ------
    CompileError: if there is no compiler or it fails.
    OSError: if the cache cannot be written.
    """
    source = source_of(function)
    key = hashlib.sha256("\n".join((platform.machine(), *FLAGS, source)).encode()).hexdigest()[:24]
    library = cache_directory() / f"{function.name()}-{key}.so"
    if not is_trusted(library):
        _build(function.name(), source, library)
    return library


def source_of(function: Any) -> str:
    """C source of ``function``."""
    generator = casadi.CodeGenerator(f"{function.name()}.c")
    generator.add(function)
    return str(generator.dump())


def is_trusted(library: Path) -> bool:
    """Whether ``library`` is complete: its digest file exists and matches its bytes."""
    try:
        return _digest_file(library).read_text(encoding="ascii") == _digest(library)
    except (OSError, UnicodeDecodeError):
        return False


def find_compiler() -> str | None:
    """Path of the C compiler: ``$CC`` if set, else the first of cc, gcc, clang on the path."""
    named = os.environ.get("CC")
    for candidate in (named,) if named else COMPILERS:
        found = shutil.which(candidate)
        if found:
            return found
    return None


def _build(name: str, source: str, library: Path) -> None:
    compiler = find_compiler()
    if compiler is None:
        raise CompileError("no C compiler found (looked for $CC, cc, gcc, clang); install one, e.g. `apt install gcc`")
    library.parent.mkdir(parents=True, exist_ok=True)
    # The work directory is inside the cache because a rename is atomic within one file system only.
    with tempfile.TemporaryDirectory(prefix=f".{name}-", dir=library.parent) as work:
        c_file, product = Path(work) / f"{name}.c", Path(work) / f"{name}.so"
        c_file.write_text(source, encoding="ascii")
        _compile([compiler, *FLAGS, f"{name}.c", "-o", f"{name}.so", "-lm"], work)
        digest = Path(work) / "digest"
        digest.write_text(_digest(product), encoding="ascii")
        os.replace(product, library)
        os.replace(digest, _digest_file(library))


def _compile(command: list[str], directory: str) -> None:
    try:
        # Relative file names and no debug information: equal sources give equal libraries.
        done = subprocess.run(
            command, cwd=directory, capture_output=True, text=True, timeout=COMPILE_LIMIT_S, check=False
        )
    except subprocess.TimeoutExpired as error:
        raise CompileError(f"{command[0]} did not finish within {COMPILE_LIMIT_S:g} s") from error
    if done.returncode != 0:
        last_words = (done.stderr or done.stdout).strip().splitlines()[-1:] or ["no message"]
        raise CompileError(f"{command[0]} failed with code {done.returncode}: {last_words[0]}")


def _digest(library: Path) -> str:
    return hashlib.sha256(library.read_bytes()).hexdigest()


def _digest_file(library: Path) -> Path:
    return library.with_suffix(".sha256")
