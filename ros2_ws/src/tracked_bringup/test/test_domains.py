from pathlib import Path

import pytest

from tracked_bringup.domains import DOMAINS, NoDomainError, run_domain


def test_the_domain_that_is_asked_for_is_taken(tmp_path: Path) -> None:
    with run_domain({"ROS_DOMAIN_ID": "44"}, skip=3, locks=tmp_path) as domain:
        assert domain == 44


def test_two_runs_at_a_time_have_two_domains(tmp_path: Path) -> None:
    with run_domain({}, locks=tmp_path) as first, run_domain({}, locks=tmp_path) as second:
        assert (first, second) == (0, 1)
    with run_domain({}, locks=tmp_path) as again:
        assert again == 0


def test_the_next_variant_gets_the_next_domain(tmp_path: Path) -> None:
    with run_domain({}, skip=1, locks=tmp_path) as domain:
        assert domain == 1


@pytest.mark.parametrize("asked", ["x", "-1", "233", "1.5"])
def test_what_is_no_domain_is_refused(tmp_path: Path, asked: str) -> None:
    with pytest.raises(NoDomainError, match="ROS_DOMAIN_ID"), run_domain({"ROS_DOMAIN_ID": asked}, locks=tmp_path):
        pass


def test_when_all_are_held_it_says_so(tmp_path: Path) -> None:
    held = [run_domain({}, locks=tmp_path) for _ in DOMAINS]
    for domain in held:
        domain.__enter__()
    with pytest.raises(NoDomainError, match="all ROS domains are in use"), run_domain({}, locks=tmp_path):
        pass
    for domain in held:
        domain.__exit__(None, None, None)
