"""What a process of nodes makes of its arguments before anything starts; the package without rclpy."""

import os
import subprocess
import sys

import pytest

from node_kit import Parameter, ParameterTable, StackNode, run

LIMIT_S = 30.0


class Documented(StackNode):
    """Drives until it is told to stop."""

    NAME = "driver"
    PARAMETERS = ParameterTable(Parameter("gain", 1.0, "Gain of it"))


def test_help_is_the_page_of_the_node(capsys):
    assert run(Documented, args=["driver", "--help"]) == 0
    output = capsys.readouterr().out
    assert "Drives until it is told to stop." in output
    assert "| `gain` | float | `1.0` |" in output


@pytest.mark.parametrize(
    ("arguments", "executor", "sentence"),
    [
        (["gain:=1.0"], "events", "unknown argument gain:=1.0; parameters are given as --ros-args -p name:=value"),
        (["--ros-args", "--nonsense"], "events", "--nonsense"),
        ([], "magic", "NODE_KIT_EXECUTOR must be events or single, got 'magic'"),
    ],
)
def test_arguments_that_make_no_sense_are_refused_before_anything_starts(
    monkeypatch, capsys, arguments, executor, sentence
):
    monkeypatch.setenv("NODE_KIT_EXECUTOR", executor)
    assert run(Documented, args=["driver", *arguments]) == 2
    assert sentence in capsys.readouterr().err


def test_package_is_imported_without_rclpy():
    script = """
import sys
sys.modules["rclpy"] = None
import node_kit
from node_kit import Parameter, ParameterTable, RejectedMessage, TransformBuffer
try:
    node_kit.nonsense
except AttributeError as error:
    print(error)
"""
    done = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        check=True,
        timeout=LIMIT_S,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert "nonsense" in done.stdout
