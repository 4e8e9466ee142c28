import math
from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st

from tracked_report.ledger import Claim, load_ledgers

REPOSITORY_CLAIMS = Path(__file__).parents[4] / "claims"
NUMBERS = st.floats(allow_nan=True, allow_infinity=True)


def claim(direction, target):
    row = {"id": "p.a", "statement": "s", "direction": direction, "target": target, "unit": "", "from": "m", "key": "k"}
    return Claim.model_validate(row)


@given(st.sampled_from(["at_most", "at_least", "equal"]), st.floats(-1e9, 1e9), NUMBERS)
def test_a_claim_holds_exactly_when_its_margin_is_not_negative(direction, target, value):
    held = claim(direction, target).holds(value)
    expected = {
        "at_most": value <= target,
        "at_least": value >= target,
        "equal": math.isclose(value, target, abs_tol=1e-12),
    }
    assert held == (math.isfinite(value) and expected[direction])


@given(NUMBERS)
def test_a_range_includes_its_ends_and_nothing_that_is_not_finite(value):
    assert claim("within", [0.75, 0.82]).holds(value) == (0.75 <= value <= 0.82)


def test_whole_numbers_that_should_be_equal_are():
    assert claim("equal", 20).holds(20.0)
    assert not claim("equal", 20).holds(19.0)


def test_targets_read_as_they_are_meant():
    assert claim("at_most", 0.15).target_text() == "<= 0.15"
    assert claim("within", [0.75, 0.82]).target_text() == "0.75 ... 0.82"


def test_the_ledgers_of_the_repository_are_sound():
    assert all(ledger.claims for ledger in load_ledgers(REPOSITORY_CLAIMS))
