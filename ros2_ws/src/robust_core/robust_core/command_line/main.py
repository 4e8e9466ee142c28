"""robust_core on the command line.

Exit codes: 0 all that was asked is proven; 1 it is not, or undecided; 2 the specification or the command is wrong.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from robust_core.command_line.fields import SpecError
from robust_core.command_line.spec import COMMAND_OF, Spec, examples, read_spec
from robust_core.errors import (
    ArgumentError,
    CertificateError,
    MissingDependencyError,
    ModelMismatchError,
    RobustCoreError,
)

COMMANDS = {
    "design": "gains, a filter or an observer with the proof of what they do",
    "certify": "what can be proven of a system or of given gains; or repeat the proof of a certificate",
    "map": "theorems asked at every point of a grid of parameters",
    "explain": "what a specification asks, or what a certificate or design proves; solves nothing",
}
_WRONG_INPUT = (SpecError, ArgumentError, MissingDependencyError, ModelMismatchError)


def main(arguments: Sequence[str] | None = None) -> int:
    """``robust_core COMMAND ...``."""
    parser = argparse.ArgumentParser(
        prog="robust_core", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name, about in COMMANDS.items():
        _options(commands.add_parser(name, help=about, description=_description(name)), name)
    options = parser.parse_args(arguments)
    return _guarded(options.command, options)


def run(command: str, arguments: Sequence[str] | None = None) -> int:
    """One command as an executable of its own, as `ros2 run` starts it."""
    parser = argparse.ArgumentParser(prog=command, description=_description(command))
    _options(parser, command)
    return _guarded(command, parser.parse_args(arguments))


def _description(command: str) -> str:
    return (
        f"{COMMANDS[command][0].upper()}{COMMANDS[command][1:]}. Exit code 0: proven, 1: not proven or undecided, "
        f"2: wrong input. Specifications that come along, by name: {', '.join(examples())}."
    )


def _options(parser: argparse.ArgumentParser, command: str) -> None:
    files = "SPEC.yaml, or a certificate or design (.json)" if command in ("certify", "explain") else "SPEC.yaml"
    parser.add_argument("file", metavar="FILE", help=files)
    if command != "explain":
        parser.add_argument("--out", type=Path, metavar="FOLDER", help="output folder (default out/robust_core/NAME)")
    if command == "map":
        parser.add_argument("--workers", type=int, metavar="N", help="processes (default all cores)")


def _guarded(command: str, options: argparse.Namespace) -> int:
    try:
        return _execute(command, options)
    except _WRONG_INPUT as error:
        print(f"{command}: {error}", file=sys.stderr)
        return 2
    except CertificateError as error:
        print(f"{command}: not proven: {error}", file=sys.stderr)
        return 1
    except RobustCoreError as error:
        print(f"{command}: undecided: {error}", file=sys.stderr)
        return 1
    except BrokenPipeError:  # the reader of the text had enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except OSError as error:
        print(f"{command}: {error}", file=sys.stderr)
        return 2


def _execute(command: str, options: argparse.Namespace) -> int:
    if options.file.endswith(".json") and command in ("certify", "explain"):
        from robust_core.command_line.proof_files import tell

        print(tell(options.file, verify=command == "certify"))
        return 0
    spec = read_spec(options.file)
    if command == "explain":
        from robust_core.command_line.asking import asking

        print(asking(spec))
        return 0
    if COMMAND_OF[spec.task] != command:
        raise SpecError(spec.task, f"is for the command {COMMAND_OF[spec.task]}")
    return _answer(spec, options)


def _answer(spec: Spec, options: argparse.Namespace) -> int:
    from robust_core.command_line.outcome import write

    folder = options.out or Path("out") / "robust_core" / spec.name
    if spec.task == "map":
        from robust_core.command_line.map_task import make_map

        if options.workers is not None and options.workers < 1:
            raise SpecError("--workers", f"must be at least 1, got {options.workers}")
        outcome = make_map(spec, folder, options.workers)
    elif spec.task == "certify":
        from robust_core.command_line.certify_task import certify

        outcome = certify(spec)
    else:
        from robust_core.command_line.design_tasks import design

        outcome = design(spec)
    print(write(outcome, spec.name, spec.about, folder))
    return outcome.exit_code


def design() -> int:
    """Executable ``design``."""
    return run("design")


def certify() -> int:
    """Executable ``certify``."""
    return run("certify")


def make_map() -> int:
    """Executable ``map``."""
    return run("map")


def explain() -> int:
    """Executable ``explain``."""
    return run("explain")


if __name__ == "__main__":
    sys.exit(main())
