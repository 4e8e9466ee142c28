"""One way to compile: numba, cached on disk under a name that changes with the sources.

numba keys its cache on the file of the function alone, so a change in a function that is called from another
file would go unnoticed. Here the cache directory carries a hash of every source that takes part.
"""

import hashlib
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

import numba
from numba.core import config

from robust_core.plants import x_structure

Function = TypeVar("Function", bound=Callable[..., object])


def source_hash() -> str:
    """Hash of this package's compiled sources and of the plant law that they call (16 hex digits)."""
    package = Path(__file__).parent
    sources = [*sorted(package.glob("belts/*.py")), Path(x_structure.__file__)]
    digest = hashlib.sha256()
    for source in sources:
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def cache_directory() -> Path:
    """Where compiled code is kept: below NUMBA_CACHE_DIR, or the user's cache directory."""
    base = os.environ.get("NUMBA_CACHE_DIR") or os.path.join(
        os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"), "tracked_stack", "numba"
    )
    return Path(base) / f"sim_bridge-{source_hash()}"


_DIRECTORY = str(cache_directory())


@contextmanager
def _own_cache() -> Iterator[None]:
    """numba picks a function's cache directory when the function is decorated; give ours, then hand back."""
    previous, config.CACHE_DIR = config.CACHE_DIR, _DIRECTORY
    try:
        yield
    finally:
        config.CACHE_DIR = previous


def compiled(function: Function) -> Function:
    """Compile ``function`` on its first call; without a writable disk it is compiled anew in every process."""
    with _own_cache():
        try:
            result: Function = numba.njit(cache=True)(function)
        except RuntimeError:  # no directory can be written
            result = numba.njit(function)
    return result
