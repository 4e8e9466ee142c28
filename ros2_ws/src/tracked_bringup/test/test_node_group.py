import sys

import pytest

from tracked_bringup.node_group import NodeClassError, load_class, main, split_arguments


def test_a_class_is_found_by_its_path() -> None:
    from tracked_safety import CommandArbiter

    assert load_class("tracked_safety:CommandArbiter") is CommandArbiter


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("no_colon", "expected MODULE:CLASS"),
        ("module:", "expected MODULE:CLASS"),
        ("no_such_module:Node", "cannot be imported"),
        ("tracked_safety:Nothing", "has no class Nothing"),
        ("tracked_safety:SOURCES", "has no class SOURCES"),
    ],
)
def test_a_path_that_names_no_class_is_refused(path: str, words: str) -> None:
    with pytest.raises(NodeClassError, match=words):
        load_class(path)


def test_ros_arguments_are_left_to_ros() -> None:
    assert split_arguments(["a:A", "b:B", "--ros-args", "-r", "x:=y"]) == (["a:A", "b:B"], ["--ros-args", "-r", "x:=y"])
    assert split_arguments(["a:A"]) == (["a:A"], [])


@pytest.mark.parametrize(
    ("arguments", "code"), [([], 2), (["--help"], 0), (["no_colon"], 2), (["no_such_module:Node", "--ros-args"], 2)]
)
def test_arguments_without_nodes_end_with_a_code(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], arguments: list[str], code: int
) -> None:
    monkeypatch.setattr(sys, "argv", ["node_group", *arguments])
    assert main() == code
    shown = capsys.readouterr()
    assert "node_group" in shown.out + shown.err
