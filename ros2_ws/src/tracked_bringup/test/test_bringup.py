import sys

import pytest

from tracked_bringup.bringup import locate_executable, main
from tracked_bringup.command_line import parser, split_options
from tracked_bringup.scenarios import ArgumentError
from tracked_bringup.supervisor import GraphFailedError


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["trakc"], "no scenario 'trakc'"),
        (["track", "durations_s:=3"], "did you mean duration_s"),
        (["track", "duration_s:=0"], "duration_s"),
        (["track", "--variant", "triple"], "no variant 'triple'; there are double"),
        (["track", "namespace:=a b"], "no ROS name"),
        (["track", "--nodes", "missing.yaml"], "missing.yaml"),
    ],
)
def test_bad_arguments_end_with_code_2_and_one_sentence(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    monkeypatch.setattr(sys, "argv", ["bringup", *arguments])
    assert main() == 2
    error = capsys.readouterr().err
    assert error.startswith("bringup: ") and words in error and error.count("\n") == 1


def test_options_and_changes_are_told_apart() -> None:
    arguments = parser().parse_args(["track", "namespace:=/r1", "seed:=3", "--grouping", "separate", "--variant", "a"])
    options, changes = split_options(arguments)
    assert options.namespace == "r1" and options.grouping == "separate" and options.variants == ("a",)
    assert changes == ["seed:=3"]


def test_a_malformed_change_is_refused() -> None:
    with pytest.raises(ArgumentError, match="key:=value"):
        split_options(parser().parse_args(["track", "seed=3"]))


def test_a_package_that_is_not_installed_is_said_with_the_remedy() -> None:
    with pytest.raises(GraphFailedError, match="make setup"):
        locate_executable("no_such_package", "node")


def test_changes_may_follow_an_option() -> None:
    arguments = parser().parse_intermixed_args(["compare", "--name", "short", "duration_s:=8"])
    assert (arguments.name, arguments.changes) == ("short", ["duration_s:=8"])
