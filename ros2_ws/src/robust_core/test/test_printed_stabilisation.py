"""Printed Theorem 2.4: refuted for every choice, with proofs that are checked."""

from pathlib import Path
from typing import Any

import pytest

from robust_core.certificates import load_certificate, save_certificate
from robust_core.errors import ArgumentError, RateError
from robust_core.plants import chua
from robust_core.stabilisation import refute_printed
from robust_core.stabilisation.refutation import positive_entry
from robust_core.stabilisation.theorem_2_4 import PrintedStabilisation
from robust_core.verdict import Verdict


@pytest.mark.parametrize(
    "problem", [chua.stabilisation, chua.synchronisation], ids=["stabilisation", "synchronisation"]
)
def test_printed_theorem_has_no_solution_for_any_choice_and_the_proof_is_checked(problem: Any, tmp_path: Path) -> None:
    model = problem()
    for z in range(4):
        for growth in ("1/1000", 1, 1000):
            result = refute_printed(model, growth=growth, z=z)
            assert result.verdict is Verdict.INFEASIBLE
    assert result.certificate is not None
    path = save_certificate(result.certificate, tmp_path / "printed.json")
    assert not load_certificate(path, model=model).feasible


def test_diagonal_entry_is_the_one_of_the_errata() -> None:
    entry = positive_entry(chua.stabilisation([30.15, 29.85, 120.6, 3.1862]), 2)
    assert entry is not None
    assert entry.value > 54.0
    assert positive_entry(chua.stabilisation([0.0, 0.0, 0.0, 0.0]), 2) is None


def test_printed_theorem_is_not_refuted_where_rates_are_slow() -> None:
    slow = chua.stabilisation([0.0, 0.0, 0.0, 0.0])
    assert refute_printed(slow).verdict is Verdict.UNDECIDED
    assert PrintedStabilisation().specialised(slow).z == 0


def test_printed_theorem_refuses_bad_options() -> None:
    with pytest.raises(ArgumentError, match="growth"):
        PrintedStabilisation(growth=0)
    with pytest.raises(ArgumentError, match="z must"):
        PrintedStabilisation(z=7).specialised(chua.stabilisation())
    with pytest.raises(RateError):
        refute_printed(chua.stabilisation(rates=None))
