"""Terminal weights out of files: what is accepted, and what is refused in which words."""

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robust_core.design_files import ProvenGains, load_design, save_design
from robust_core.errors import CertificateDamagedError, CertificateMismatchError
from robust_core.observers import design_observer
from robust_core.plants.tracking_error import TrackingError
from robust_core.plants.vibration_sensor import VibrationSensor
from robust_core.terminal import (
    CommandLimits,
    TerminalDesign,
    design_tracking_terminal,
    load_tracking_terminal,
    loading,
)

MODEL = TrackingError(period_s=0.2, speed_mps=(0.2, 0.4), yaw_rate_radps=0.6, heading_rad=0.3)
LIMITS = CommandLimits(speed_mps=(-0.4, 0.5), yaw_rate_radps=1.3, belt_mps=0.75, half_track_m=0.25)
WEIGHTS: dict[str, Any] = {"position": 20.0, "heading": 2.0, "speed": 1.0, "yaw_rate": 0.5}


@pytest.fixture(scope="module")
def design() -> TerminalDesign:
    return design_tracking_terminal(MODEL, LIMITS, **WEIGHTS)


@pytest.fixture
def path(design: TerminalDesign, tmp_path: Path) -> Path:
    return save_design(design.result.require(), tmp_path / "terminal.json")


def test_file_gives_weight_gain_and_level_back(design: TerminalDesign, path: Path) -> None:
    found = load_tracking_terminal(path, MODEL, LIMITS, **WEIGHTS)
    assert np.array_equal(found.P, design.P)
    assert np.array_equal(found.K, design.K)
    assert found.level == pytest.approx(design.level)


def test_wider_limits_of_the_robot_keep_the_proof(path: Path) -> None:
    wide = replace(LIMITS, yaw_rate_radps=2.0, belt_mps=1.0)
    assert load_tracking_terminal(path, MODEL, wide, **WEIGHTS).level > 0.0


@pytest.mark.parametrize(
    "change", [{"yaw_rate_radps": 1.2}, {"belt_mps": 0.7}, {"half_track_m": 0.3}, {"speed_mps": (-0.4, 0.45)}]
)
def test_narrower_limits_are_others(path: Path, change: Any) -> None:
    with pytest.raises(CertificateMismatchError, match="limits of the commands"):
        load_tracking_terminal(path, MODEL, replace(LIMITS, **change), **WEIGHTS)


@pytest.mark.parametrize(
    ("name", "kind"), [("position", "state"), ("heading", "state"), ("speed", "input"), ("yaw_rate", "input")]
)
def test_other_weights_are_named(path: Path, name: str, kind: str) -> None:
    with pytest.raises(CertificateMismatchError, match=f"other {kind} weights"):
        load_tracking_terminal(path, MODEL, LIMITS, **{**WEIGHTS, name: 1.01 * WEIGHTS[name]})


@pytest.mark.parametrize(
    "change", [{"period_s": 0.1}, {"heading_point": 0.0}, {"speed_mps": (0.2, 0.41)}, {"yaw_rate_radps": 0.7}]
)
def test_other_references_are_another_model(path: Path, change: Any) -> None:
    with pytest.raises(CertificateMismatchError, match="another model"):
        load_tracking_terminal(path, replace(MODEL, **change), LIMITS, **WEIGHTS)


def test_changed_weight_is_noticed(path: Path) -> None:
    content = json.loads(path.read_text(encoding="utf-8"))
    content["gains"]["P"][0][0] *= 1.0001
    path.write_text(json.dumps(content), encoding="utf-8")
    with pytest.raises(CertificateDamagedError, match="gains"):
        load_design(path)


def test_cut_file_is_noticed(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:5000])
    with pytest.raises(CertificateDamagedError, match=r"terminal\.json"):
        load_tracking_terminal(path, MODEL, LIMITS, **WEIGHTS)


def test_other_designs_are_no_terminal_weight(monkeypatch: pytest.MonkeyPatch) -> None:
    certificate = design_observer(VibrationSensor().plant(), 80.0).result.require()
    monkeypatch.setattr(loading, "load_design", lambda path, model: ProvenGains({}, certificate))
    with pytest.raises(CertificateMismatchError, match="no terminal weight"):
        load_tracking_terminal("observer.json", MODEL, LIMITS, **WEIGHTS)


def test_loading_imports_no_solver(path: Path) -> None:
    script = (
        "import sys; from robust_core.terminal import load_tracking_terminal; "
        "from robust_core.design_files import load_design; load_design(sys.argv[1]); "
        "print([m for m in ('clarabel', 'scipy', 'casadi', 'cvxpy') if m in sys.modules])"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-c", script, str(path)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
    assert done.stdout.strip() == "[]"
