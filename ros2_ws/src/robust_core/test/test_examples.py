"""Examples in docstrings and on the documentation page run as written."""

import doctest
import importlib
import pkgutil
from pathlib import Path

import pytest

import robust_core

OPTIONS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
MODULES = sorted(info.name for info in pkgutil.walk_packages(robust_core.__path__, "robust_core."))
PAGE = Path(__file__).parents[4] / "docs" / "robust_core.md"


@pytest.mark.parametrize("name", MODULES)
def test_docstring_examples_run(name) -> None:
    found = doctest.testmod(importlib.import_module(name), optionflags=OPTIONS)
    assert found.failed == 0


def test_examples_of_the_page_run(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    found = doctest.testfile(str(PAGE), module_relative=False, optionflags=OPTIONS)
    assert found.attempted > 10
    assert found.failed == 0
