"""The command line: what it writes, its exit codes, and specifications that are wrong."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from robust_core.command_line import spec as spec_files
from robust_core.command_line.main import main
from robust_core.design_files import load_design, save_design
from robust_core.errors import ArgumentError, CertificateDamagedError, CertificateMismatchError
from robust_core.plants import chua

STABLE = "{vertices: {A: [[[-1, 0], [0, -2]], [[-3, 1/3], [0, -1]]]}}"
PUSHED = "{vertices: {A: [[[0, 1], [1, 0]], [[0, 1], [2, 0]]], B: [[0], [1]]}}"
FORMULAS = "states: [x, v]\n  box: {x: [-1, 1], v: [-1, 1]}"


def write_spec(folder: Path, text: str) -> str:
    path = folder / "spec.yaml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def answer(folder: Path, command: str, text: str) -> int:
    return main([command, write_spec(folder, text), "--out", str(folder / "out")])


@pytest.mark.parametrize("name", spec_files.examples())
def test_every_example_is_proven_and_explained(name, tmp_path, capsys) -> None:
    spec = spec_files.read_spec(name)
    assert main(["explain", name]) == 0
    command = spec_files.COMMAND_OF[spec.task]
    path = name
    if spec.task == "map":
        text = (Path(spec_files.__file__).parents[1] / "specs" / name).read_text(encoding="utf-8")
        path = write_spec(tmp_path, text.replace("count: 21", "count: 3"))
    assert main([command, path, "--out", str(tmp_path / "out")]) == 0
    shown = capsys.readouterr().out
    assert "Found: proven" in shown
    written = {file.name for file in (tmp_path / "out").iterdir()}
    assert {"explanation.md", "plot.svg"} <= written
    assert written & {"certificate.json", "map.csv"}


def test_a_design_is_loaded_with_its_proof_and_not_with_another_digit(tmp_path, capsys) -> None:
    assert main(["design", "vibration_observer.yaml", "--out", str(tmp_path)]) == 0
    file = tmp_path / "design.json"
    design = load_design(file)
    assert set(design.gains) == {"E", "X"} and design.certificate.feasible
    assert main(["certify", str(file)]) == 0 and main(["explain", str(tmp_path / "certificate.json")]) == 0
    with pytest.raises(CertificateMismatchError):
        load_design(file, model=chua.stabilisation())
    content = json.loads(file.read_text(encoding="utf-8"))
    content["gains"]["X"][0][0] += 1e-9
    file.write_text(json.dumps(content), encoding="utf-8")
    capsys.readouterr()
    assert main(["certify", str(file)]) == 1
    assert "not those that its certificate is about" in capsys.readouterr().err


@pytest.mark.parametrize("content", ["", "[]", "{}", '{"format": "x", "gains": {}, "certificate": {}}'])
def test_what_is_no_design_is_refused(content, tmp_path) -> None:
    file = tmp_path / "design.json"
    file.write_text(content, encoding="utf-8")
    with pytest.raises(CertificateDamagedError):
        load_design(file)
    assert main(["certify", str(file)]) == 1


def test_certificates_of_no_design_make_no_design_file(tmp_path) -> None:
    from robust_core import CommonLyapunov, PolytopicSystem, decide

    certificate = decide(CommonLyapunov(), PolytopicSystem.of([[[-1.0]]])).require()
    with pytest.raises(ArgumentError, match="gains, a filter, an observer or a terminal weight"):
        save_design(certificate, tmp_path / "design.json")


@pytest.mark.parametrize(
    ("task", "command", "code"),
    [
        ("certify: {theorem: 2.1}", "certify", 0),
        ("certify: {theorem: 2.1, decay: 5}", "certify", 1),
        ("certify: {half_widths: [1, 2]}", "certify", 0),
        ("certify: {region: {disc: [-5, 4.9], sector: 0.5, half_plane: -0.5}}", "certify", 0),
        ("certify: {theorem: 2.3}", "certify", 1),
        ("certify:", "certify", 0),
        ("certify: {theorem: 2.1}", "design", 2),
    ],
)
def test_exit_codes_say_what_is_proven(task, command, code, tmp_path) -> None:
    assert answer(tmp_path, command, f"system: {STABLE}\n{task}\n") == code


@pytest.mark.parametrize(
    "asked",
    [
        "{decay: 0.5, region: {half_plane: -0.6}}",
        "{input_limit: [5], start: [[0.1, 0]], objective: small set}",
        "{method: dependent, rates_hold_in_closed_loop: true, gain_bound: 100}",
    ],
)
def test_gains_are_designed_from_vertices(asked, tmp_path) -> None:
    system = PUSHED[:-1] + ", rates: [0.1, 0.1]}"
    assert answer(tmp_path, "design", f"system: {system}\nstabilise: {asked}\n") == 0
    assert load_design(tmp_path / "out" / "design.json").gains["K"].shape == (2, 1, 2)


def test_different_input_matrices_are_designed_for_in_pairs(tmp_path) -> None:
    system = "{vertices: {A: [[[0, 1], [1, 0]], [[0, 1], [2, 0]]], B: [[[0], [1]], [[0], [2]]]}}"
    assert answer(tmp_path, "design", f"system: {system}\nstabilise: {{decay: 0.5}}\n") == 0


@pytest.mark.parametrize(
    "asked",
    [
        "{band: [1, 2]}",
        "{order: 1, fastest_pole: 50}",
        "{index: energy_to_peak, fastest_pole: 50}",
        "{index: passive, fastest_pole: 50}",
        "{index: {kind: dissipative, Q: [[-1]], S: [[1]], R: [[0]]}, fastest_pole: 50}",
    ],
)
def test_filters_are_designed(asked, tmp_path) -> None:
    system = (
        "{vertices: {A: [[[-1, 1], [0, -2]], [[-1, 2], [0, -3]]], B: [[0], [1]], C: [[1, 0]], E: [[1, 0]], F: [[0.1]]}}"
    )
    assert answer(tmp_path, "design", f"system: {system}\nfilter: {asked}\n") == 0


def test_given_filters_and_observers_are_certified(tmp_path) -> None:
    system = "{vertices: {A: [[[-1]], [[-2]]], B: [[1]], C: [[1]], E: [[1]], F: [[0]]}}"
    given = "certify: {filter: {A: [[-1]], B: [[0]], C: [[0]]}}"
    assert answer(tmp_path, "certify", f"system: {system}\n{given}\n") == 0
    system = "{A: [[1, 0.001], [-0.04, 0.96]], B: [[0], [1]], C: [[1, 0]], Df: [[0], [0.001]], D: [[0], [0.001]]}"
    for tau, code in ((79, 0), (999, 1)):
        given = f"certify: {{tau: {tau}, observer: {{E: [[0], [-40]], X: [[1], [-40.04]]}}}}"
        assert answer(tmp_path, "certify", f"system: {system}\n{given}\n") == code
    assert answer(tmp_path, "design", f"system: {system}\nobserver: {{tau: 2000}}\n") == 2


def test_a_drawing_without_matplotlib_is_said_and_all_else_is_written(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    assert answer(tmp_path, "certify", f"system: {STABLE}\ncertify: {{}}\n") == 0
    assert "no plot" in capsys.readouterr().out
    monkeypatch.setitem(sys.modules, "yaml", None)
    assert answer(tmp_path, "certify", f"system: {STABLE}\ncertify: {{}}\n") == 2


def test_designs_from_files_equal_those_from_the_library(tmp_path) -> None:
    from robust_core.observers import design_observer

    assert main(["design", "vibration_observer.yaml", "--out", str(tmp_path)]) == 0
    loaded = load_design(tmp_path / "design.json")
    again = design_observer(loaded.certificate.model, 80.0)  # type: ignore[arg-type]
    assert np.array_equal(loaded.gains["X"], again.observer.matrices(loaded.certificate.model)["X"])  # type: ignore[arg-type]


def test_importing_explaining_and_checking_proofs_need_no_solver(tmp_path) -> None:
    assert main(["design", "vibration_observer.yaml", "--out", str(tmp_path)]) == 0
    program = """
import sys
import robust_core
light = {"numpy", "scipy", "clarabel", "casadi", "cvxpy", "matplotlib", "yaml"} & set(sys.modules)
assert not light, light
import robust_core.certificates, robust_core.plants.chua, robust_core.models, robust_core.theorems
from robust_core.command_line.main import main
assert main(["explain", "example_map.yaml"]) == 0
assert main(["certify", sys.argv[1]]) == 0
heavy = {"scipy", "clarabel", "casadi", "cvxpy", "matplotlib"} & set(sys.modules)
assert not heavy, heavy
"""
    command = [sys.executable, "-c", program, str(tmp_path / "design.json")]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=environment())


def test_what_the_solver_cannot_find_is_undecided(tmp_path, capsys) -> None:
    system = "{vertices: {A: [[[1, 0], [0, -2]]], B: [[0], [1]]}}"  # one state is out of reach
    assert answer(tmp_path, "design", f"system: {system}\nstabilise: {{}}\n") == 1
    assert "undecided" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["design", "certify", "map", "explain"])
def test_every_command_is_an_executable_of_its_own(command) -> None:
    script = Path(__file__).parents[1] / "scripts" / command
    done = subprocess.run(
        [sys.executable, script, "--help"], capture_output=True, text=True, env=environment(), check=True
    )
    assert done.stdout.startswith(f"usage: {command} ") and os.access(script, os.X_OK)


def test_an_output_folder_that_is_a_file_ends_with_two(tmp_path) -> None:
    (tmp_path / "out").write_text("", encoding="utf-8")
    assert answer(tmp_path, "certify", f"system: {STABLE}\ncertify: {{}}\n") == 2


def test_a_certificate_that_rules_out_is_written_and_no_design(tmp_path, capsys) -> None:
    system = "{vertices: {A: [[[1]]]}}"
    assert answer(tmp_path, "certify", f"system: {system}\ncertify: {{}}\n") == 1
    file = tmp_path / "out" / "certificate.json"
    assert main(["certify", str(file)]) == 0
    assert "has no solution" in capsys.readouterr().out
    from robust_core import load_certificate

    with pytest.raises(ArgumentError, match="a design that works"):
        save_design(load_certificate(file), tmp_path / "design.json")


def test_gains_of_another_loop_are_refused(tmp_path) -> None:
    model = chua.stabilisation()
    from robust_core import CommonLyapunov, decide

    certificate = decide(CommonLyapunov(), model.closed_loop(chua.PRINTED_STABILISATION_GAINS)).require()
    gains = np.array(chua.PRINTED_STABILISATION_GAINS, dtype=float)
    assert load_design(save_design(certificate, tmp_path / "a", gains=gains, open_loop=model), model=model).gains
    with pytest.raises(ArgumentError, match="loop is closed by"):
        save_design(certificate, tmp_path / "b", gains=1.001 * gains, open_loop=model)
    content = json.loads((tmp_path / "a").read_text(encoding="utf-8"))
    content["gains"] = {"L": 1}
    (tmp_path / "a").write_text(json.dumps(content), encoding="utf-8")
    with pytest.raises(CertificateDamagedError, match="malformed"):
        load_design(tmp_path / "a")


def test_a_reader_who_had_enough_is_no_error_message() -> None:
    program = (
        "import sys; from robust_core.command_line.main import main; sys.exit(main(['explain', 'example_map.yaml']))"
    )
    reading, writing = os.pipe()
    os.close(reading)
    with os.fdopen(writing, "wb") as pipe:
        done = subprocess.run(
            [sys.executable, "-u", "-c", program], stdout=pipe, stderr=subprocess.PIPE, env=environment(), check=False
        )
    assert done.stderr == b""


def environment() -> dict[str, str]:
    """That of this process, with its paths."""
    return {**os.environ, "PYTHONPATH": os.pathsep.join(entry for entry in sys.path if entry)}
