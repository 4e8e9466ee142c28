"""Certificates: proofs without a solver, and files that notice every changed digit."""

import json
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robust_core.analysis import decide
from robust_core.certificates import Certificate, load_certificate, save_certificate
from robust_core.certificates.files import from_content, to_content
from robust_core.errors import (
    ArgumentError,
    CertificateDamagedError,
    CertificateMismatchError,
    ProofFailedError,
    RobustCoreError,
)
from robust_core.lmi.unknowns import _exact_probes
from robust_core.models import PolytopicSystem
from robust_core.models.polytope import digest_of
from robust_core.plants import example_2_4_1
from robust_core.rational import rational
from robust_core.theorems import CommonLyapunov, ParameterDependent, Relaxed, Slack, TensorProduct
from robust_core.theorems.base import option_number
from robust_core.verdict import Verdict

RATES = (1.2, 1.2, 0.15, 0.15)
MODEL = example_2_4_1.system(-14, 100, RATES)
SOLUTION = decide(Relaxed(decay="0.1"), MODEL).require()
REFUTATION = decide(CommonLyapunov(), MODEL).certificate
CERTIFICATES = {"solution": SOLUTION, "refutation": REFUTATION}


@pytest.fixture(params=["solution", "refutation"])
def certificate(request) -> Certificate:
    return CERTIFICATES[request.param]


def sealed(content: dict) -> dict:
    """The content with a digest that fits, as a forger would make it."""
    return {**content, "digest": digest_of({k: v for k, v in content.items() if k != "digest"})}


def test_certificates_verify_and_survive_their_file(certificate, tmp_path) -> None:
    path = save_certificate(certificate, tmp_path / "certificate.json")
    again = load_certificate(path, model=MODEL)
    assert again.claim == certificate.claim
    assert again.theorem == certificate.theorem
    assert again.verify("exact").keys() == certificate.verify("exact").keys()


def test_a_solution_also_verifies_in_floating_point_with_margins() -> None:
    assert min(SOLUTION.verify("float").values()) > 0.0
    with pytest.raises(ArgumentError, match="exact"):
        REFUTATION.verify("float")


def leaves(node, path=()):
    """Paths of all texts in nested data."""
    if isinstance(node, dict):
        for key, value in node.items():
            yield from leaves(value, (*path, key))
    elif isinstance(node, list):
        for key, value in enumerate(node):
            yield from leaves(value, (*path, key))
    elif isinstance(node, str):
        yield path


@given(st.sampled_from(sorted(CERTIFICATES)), st.integers(0, 10**6), st.integers(1, 9))
def test_every_changed_digit_is_noticed(kind, pick, change) -> None:
    content = json.loads(json.dumps(to_content(CERTIFICATES[kind])))
    places = [path for path in leaves(content) if any(c.isdigit() for c in str_at(content, path))]
    path = places[pick % len(places)]
    text = str_at(content, path)
    digits = [k for k, letter in enumerate(text) if letter.isdigit()]
    where = digits[pick % len(digits)]
    set_at(content, path, text[:where] + str((int(text[where]) + change) % 10) + text[where + 1 :])
    with pytest.raises(RobustCoreError):
        from_content(content).verify("exact")


def str_at(content, path) -> str:
    for key in path:
        content = content[key]
    return content


def set_at(content, path, value) -> None:
    for key in path[:-1]:
        content = content[key]
    content[path[-1]] = value


def test_a_forged_digest_does_not_hide_a_solution_that_is_none() -> None:
    content = json.loads(json.dumps(to_content(SOLUTION)))
    content["values"]["P"]["values"][0] = "-1.0"
    with pytest.raises(ProofFailedError, match="P_r > 0"):
        from_content(sealed(content)).verify("exact")
    content = json.loads(json.dumps(to_content(SOLUTION)))
    content["theorem"]["options"]["decay"] = "100"
    with pytest.raises(ProofFailedError, match=r"2\.2\.8"):
        from_content(sealed(content)).verify("exact")


@pytest.mark.parametrize("scale", [0, -1])
def test_a_forged_digest_does_not_hide_multipliers_that_rule_out_nothing(scale) -> None:
    content = json.loads(json.dumps(to_content(REFUTATION)))
    for entry in content["multipliers"].values():
        entry["values"] = [str(scale * rational(text)) for text in entry["values"]]
    with pytest.raises(ProofFailedError):
        from_content(sealed(content)).verify("exact")


def test_multipliers_off_by_one_part_in_a_billion_are_no_proof() -> None:
    name = next(iter(REFUTATION.multipliers))
    changed = {key: value.copy() for key, value in REFUTATION.multipliers.items()}
    changed[name][0, 0, 0] = changed[name][0, 0, 0] * rational("1.000000001")
    with pytest.raises(ProofFailedError, match="annihilate"):
        Certificate(REFUTATION.theorem, MODEL, None, changed).verify()
    with pytest.raises(ProofFailedError, match="not those"):
        Certificate(REFUTATION.theorem, MODEL, None, {name: changed[name]}).verify()
    skew = {key: value.copy() for key, value in REFUTATION.multipliers.items()}
    skew[name][0, 0, 1] = skew[name][0, 0, 1] + 1
    with pytest.raises(ProofFailedError, match="symmetric"):
        Certificate(REFUTATION.theorem, MODEL, None, skew).verify()


def test_another_model_or_theorem_is_refused(tmp_path) -> None:
    path = save_certificate(SOLUTION, tmp_path / "certificate.json")
    with pytest.raises(CertificateMismatchError, match="another model"):
        load_certificate(path, model=example_2_4_1.system(-14, 101, RATES))
    for change, expected in (
        ({"name": "2.9"}, "no theorem is called"),
        ({"options": {}}, "has the options"),
        ({"options": {"decay": "-1", "z": 0}}, "decay"),
    ):
        content = json.loads(json.dumps(to_content(SOLUTION)))
        content["theorem"] |= change
        with pytest.raises(CertificateMismatchError, match=expected):
            from_content(sealed(content))


@pytest.mark.parametrize(
    "text", ["", "{", "[]", "{}", '{"format": "robust_core certificate 1"}', '{"format": "other"}', "null"]
)
def test_files_that_are_no_certificates_are_refused(text, tmp_path) -> None:
    path = tmp_path / "certificate.json"
    path.write_text(text)
    with pytest.raises(CertificateDamagedError):
        load_certificate(path)
    with pytest.raises(CertificateDamagedError, match="cannot be read"):
        load_certificate(tmp_path / "missing.json")


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("values", "P", "shape"), [2, 2]),
        (("values", "P", "values"), ["nan"] * 16),
        (("values", "P", "values"), None),
        (("values",), None),
        (("model", "A", "shape"), [4, 4]),
        (("model", "rates"), {"low": [], "high": []}),
        (("model",), {}),
        (("margins",), []),
        (("theorem",), None),
    ],
)
def test_malformed_content_is_refused_even_with_a_fitting_digest(path, value) -> None:
    content = json.loads(json.dumps(to_content(SOLUTION)))
    set_at(content, path, value)
    with pytest.raises(RobustCoreError):
        from_content(sealed(content)).verify("exact")


def test_unknown_kinds_of_models_are_refused() -> None:
    content = json.loads(json.dumps(to_content(SOLUTION)))
    content["model"]["kind"] = "other"
    with pytest.raises(CertificateMismatchError, match="kind"):
        from_content(sealed(content))


def test_a_certificate_is_a_solution_or_a_refutation() -> None:
    with pytest.raises(ArgumentError, match="not both"):
        Certificate(SOLUTION.theorem, MODEL, None, None)
    with pytest.raises(ArgumentError, match="stability"):
        REFUTATION.vertex_matrices()


@pytest.mark.parametrize("theorem", [ParameterDependent(), Slack(), TensorProduct()])
def test_refutations_of_theorems_with_free_unknowns_are_exact(theorem) -> None:
    result = decide(theorem, example_2_4_1.system(0, 200, [60.0, 60.0, 4.0, 4.0]))
    assert result.verdict is Verdict.INFEASIBLE
    assert result.certificate is not None
    result.certificate.verify()


def test_verdicts_are_no_booleans() -> None:
    with pytest.raises(TypeError, match="not a boolean"):
        bool(Verdict.PROVEN)


def test_plants_and_certificates_import_no_solver_and_the_package_is_light() -> None:
    code = (
        "import sys, robust_core, robust_core.certificates, robust_core.theorems, robust_core.plants.x_structure\n"
        "import robust_core.plants.example_2_4_1, robust_core.models\n"
        "print(sorted({'clarabel', 'casadi', 'scipy', 'cvxpy', 'cvxopt'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=env())
    assert done.stdout.strip() == "[]"
    light = "import sys, robust_core; print('numpy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", light], capture_output=True, text=True, check=True, env=env())
    assert done.stdout.strip() == "False"


def env() -> dict[str, str]:
    """The environment with the paths of this process."""
    import os

    return {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}


def test_exact_arithmetic_without_flint_proves_the_same(monkeypatch) -> None:
    from robust_core import rational as module

    monkeypatch.setattr(module, "_fmpq", None)
    forget()
    fresh = example_2_4_1.system(-14, 100, RATES)
    assert fresh.digest == MODEL.digest
    Certificate(SOLUTION.theorem, fresh, SOLUTION.values).verify()
    again = from_content(json.loads(json.dumps(to_content(REFUTATION))))
    again.verify()
    forget()


def forget() -> None:
    """Drop the exact numbers that are kept between calls."""
    option_number.cache_clear()
    _exact_probes.cache_clear()


def test_models_with_one_vertex_and_one_state_work() -> None:
    result = decide(CommonLyapunov(), PolytopicSystem.of([[[-1.0]]]))
    assert result.verdict is Verdict.PROVEN
    assert decide(CommonLyapunov(), PolytopicSystem.of([[[1.0]]])).verdict is Verdict.INFEASIBLE
    assert np.isfinite(result.margin)
