"""What people may get wrong at the command line: each ends with an exit code and words."""

import math
import random
from pathlib import Path

import pytest
import yaml

from robust_core.command_line import spec as spec_files
from robust_core.command_line.main import main, run

STABLE = "{vertices: {A: [[[-1, 0], [0, -2]], [[-3, 1/3], [0, -1]]]}}"
PUSHED = "{vertices: {A: [[[0, 1], [1, 0]], [[0, 1], [2, 0]]], B: [[0], [1]]}}"
FORMULAS = "states: [x, v]\n  box: {x: [-1, 1], v: [-1, 1]}"


def write_spec(folder: Path, text: str) -> str:
    path = folder / "spec.yaml"
    path.write_text(text, encoding="utf-8")
    return str(path)


def answer(folder: Path, command: str, text: str) -> int:
    return main([command, write_spec(folder, text), "--out", str(folder / "out")])


FAILURES = [
    ("system: {}\n", "asks one of"),
    ("system: {}\ncertify: {}\nmap: {}\n", "asks one of"),
    ("sytem: {}\ncertify: {}\n", "did you mean 'system'"),
    ("name: a/b\nsystem: {}\ncertify: {}\n", "it names a folder"),
    ("- 1\n", "must be a mapping"),
    ("1: 2\n", "keys are texts"),
    ("certify: {}\n", "system: is missing"),
    ("system: [\n", "is no YAML"),
    ("system: {a: &x 1, b: *x}\ncertify: {}\n", "aliases are not allowed"),
    ("system: {}\nsystem: {}\ncertify: {}\n", "is there twice"),
    ("system: {vertices: {}}\ncertify: {}\n", "system.vertices.A: is missing"),
    ("system: {vertices: {A: [[[1, 2], [3]]]}}\ncertify: {}\n", "rows of different lengths"),
    ("system: {vertices: {A: [[[.nan]]]}}\ncertify: {}\n", "system.vertices.A[0][0][0]"),
    ("system: {vertices: {A: [[[true]]]}}\ncertify: {}\n", "system.vertices.A[0][0][0]"),
    ("system: {vertices: {A: [[[1/0]]]}}\ncertify: {}\n", "no finite value"),
    ("system: {vertices: {A: [[[1, 2]]]}}\ncertify: {}\n", "system.vertices: A must be"),
    ("system: {vertices: {A: [[[1]]]}, groups: 3}\ncertify: {}\n", "system.groups"),
    ("system: {vertices: {A: [[[1]]]}, totals: [2]}\ncertify: {}\n", "totals"),
    (f"system: {STABLE}\ncertify: {{theorem: 9}}\n", "certify.theorem: must be one of"),
    (f"system: {STABLE}\ncertify: {{decay: fast}}\n", "certify.decay"),
    (f"system: {STABLE}\ncertify: {{decay: 1, region: {{disc: [1, 2]}}}}\n", "certify.region"),
    (f"system: {STABLE}\ncertify: {{region: {{disc: [1]}}}}\n", "certify.region.disc"),
    (f"system: {STABLE}\ncertify: {{region: {{}}}}\n", "at least one"),
    (f"system: {STABLE}\ncertify: {{filter: {{}}, observer: {{}}}}\n", "not both"),
    (f"system: {STABLE}\ncertify: {{gains: [[[1]]]}}\n", "certify.gains"),
    (f"system: {STABLE}\nstabilise: {{}}\n", "a system with inputs"),
    (f"system: {PUSHED}\nstabilise: {{method: magic}}\n", "stabilise.method: must be one of"),
    (f"system: {PUSHED}\nstabilise: {{gain_bound: 3}}\n", "is for method dependent"),
    (f"system: {PUSHED}\nstabilise: {{box: {{0: 1}}}}\n", "keys are texts"),
    (f"system: {PUSHED}\nstabilise: {{method: dependent, input_limit: 1}}\n", "is for method quadratic"),
    (f"system: {PUSHED}\nstabilise: {{digits: 1}}\n", "stabilise.digits: must be a whole number"),
    (f"system: {PUSHED}\nstabilise: {{start: 3}}\n", "stabilise.start: must be a list of points"),
    (f"system: {PUSHED}\nstabilise: {{input_limit: [[1]]}}\n", "stabilise.input_limit: must be a number"),
    ("system: {A: 1, B: [[1]], C: [[1]], Df: [[1]], D: [[1]]}\nobserver: {tau: 1}\n", "system.A: must be a matrix"),
    (f"system: {PUSHED}\nstabilise: {{input_limit: -1}}\n", "input_limit must be positive"),
    (f"system: {STABLE}\nfilter: {{}}\n", "system.vertices.B: is missing"),
    ("system: {vertices: {}, attained: maybe}\nfilter: {}\n", "is missing"),
    ("system:\n  states: x\ncertify: {}\n", "system.states"),
    ("system:\n  states: [sin]\ncertify: {}\n", "system.states"),
    ("system:\n  states: [x]\n  box: {x: [1, 0]}\ncertify: {}\n", "system.box.x"),
    ("system:\n  states: [x]\n  box: {y: [1, 0]}\ncertify: {}\n", "system.box.y: is no key here"),
    (f"system:\n  {FORMULAS}\n  terms: {{x: v}}\n  A: [[x]]\ncertify: {{}}\n", "no name that is free"),
    (f"system:\n  {FORMULAS}\n  terms: {{s: x^2}}\n  A: [[0, 1], [x, -1]]\ncertify: {{}}\n", "'x' is no name here"),
    (f"system:\n  {FORMULAS}\n  terms: {{s: x^2}}\n  A: [0, 1]\ncertify: {{}}\n", "must be a matrix"),
    (f"system:\n  {FORMULAS}\n  terms: {{s: x^2}}\n  A: [[0, 1], [s^2, 1]]\ncertify: {{}}\n", "affine in the terms"),
    (f"system:\n  {FORMULAS}\n  terms: {{s: x^2}}\n  weights: [1]\n  A: [[1]]\ncertify: {{}}\n", "follows from terms"),
    (f"system:\n  {FORMULAS}\n  A: [[-1, 0], [0, -1]]\n  weights: [1]\n  vertices: {{A: 1}}\ncertify: {{}}\n", "list"),
    (
        f"system:\n  {FORMULAS}\n  A: [[-1, 0], [0, -1]]\n  weights: [1]\n  vertices: {{A: [[[-1, 0], [0, -2]]]}}\n"
        "certify: {}\n",
        "do not mix",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("text", "named"), FAILURES)
def test_wrong_specifications_are_named_and_end_with_two(text, named, tmp_path, capsys) -> None:
    spec = write_spec(tmp_path, text)
    command = "certify" if "certify" in text else "design"
    assert main([command, spec, "--out", str(tmp_path / "out")]) == 2
    assert named in capsys.readouterr().err


ODD = [
    None,
    True,
    [],
    {},
    "x",
    "nan",
    0,
    -1,
    1e300,
    "1/0",
    [[1]],
    [[[1]]],
    {"a": 1},
    "sin(x1)",
    [[1, 2], [3]],
    math.inf,
]


@pytest.mark.parametrize("seed", range(6))
def test_specifications_with_any_value_replaced_end_with_an_exit_code(seed, tmp_path, capsys) -> None:
    rng = random.Random(seed)
    for _ in range(12):
        name = rng.choice(["chua_stabilisation.yaml", "tunnel_diode_filter.yaml", "vibration_observer.yaml"])
        content = yaml.safe_load((Path(spec_files.__file__).parents[1] / "specs" / name).read_text(encoding="utf-8"))
        holder, key = rng.choice(list(places(content)))
        holder[key] = rng.choice(ODD)
        assert answer(tmp_path, "design", yaml.safe_dump(content)) in (0, 1, 2)


def places(content):
    """Every mapping or list within, with each of its keys."""
    for key in list(content) if isinstance(content, dict) else range(len(content)):
        yield content, key
        if isinstance(content[key], dict | list):
            yield from places(content[key])


MAPPED = f"""system:
  {FORMULAS}
  terms: {{square: x^2}}
  A: [[0, 1], [-1 - a*square, -1]]
map:
"""


@pytest.mark.parametrize(
    ("asked", "named"),
    [
        ("  theorems: [2.1]", "map.parameters: is missing"),
        ("  theorems: [2.1]\n  parameters: {}", "at least one parameter"),
        ("  theorems: [2.1]\n  parameters: {a: {low: 1, high: 0, count: 3}}", "map.parameters.a.high"),
        ("  theorems: [2.1]\n  parameters: {a: {low: 0, high: 1, count: 1.5}}", "map.parameters.a.count"),
        ("  theorems: [2.1]\n  parameters: {x: {low: 0, high: 1, count: 2}}", "share a name"),
        ("  theorems: 2.1\n  parameters: {a: {low: 0, high: 1, count: 2}}", "map.theorems"),
        ("  theorems: [2.1]\n  parameters: {a b: {low: 0, high: 1, count: 2}}", "is no name"),
    ],
)
def test_wrong_maps_are_named(asked, named, tmp_path, capsys) -> None:
    assert answer(tmp_path, "map", MAPPED + asked + "\n") == 2
    assert named in capsys.readouterr().err


def test_a_map_over_one_parameter_counts_verdicts_and_goes_on_from_its_file(tmp_path, capsys) -> None:
    text = MAPPED + "  theorems: [2.1, 2.3]\n  parameters: {a: {low: 0.1, high: 0.4, count: 5}}\n"
    for _ in range(2):
        assert answer(tmp_path, "map", text) == 0
    rows = (tmp_path / "out" / "map.csv").read_text(encoding="utf-8").splitlines()
    assert rows[0] == "a,theorem 2.1,theorem 2.3" and len(rows) == 6
    assert rows[1] == "0.1,proven,proven"
    assert main(["map", write_spec(tmp_path, text), "--out", str(tmp_path / "out"), "--workers", "0"]) == 2


def test_files_that_are_not_there_or_too_large_end_with_two(tmp_path, capsys) -> None:
    assert main(["design", str(tmp_path / "none.yaml")]) == 2
    assert "examples are" in capsys.readouterr().err
    assert main(["design", write_spec(tmp_path, "#" * 1_000_001)]) == 2


def test_a_command_without_arguments_ends_with_two_and_help_with_zero(capsys) -> None:
    for arguments, code in (([], 2), (["--help"], 0)):
        with pytest.raises(SystemExit) as ended:
            run("design", arguments)
        assert ended.value.code == code
    assert "SPEC.yaml" in capsys.readouterr().out
