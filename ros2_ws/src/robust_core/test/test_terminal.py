"""Terminal weight and set: the proof against the unicycle itself."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robust_core.certificates import load_certificate, save_certificate
from robust_core.errors import ArgumentError, ProofFailedError, SolverError
from robust_core.models import PolytopicSystem
from robust_core.plants.tracking_error import TrackingError
from robust_core.terminal import (
    CommandLimits,
    TerminalDesign,
    TerminalIngredient,
    design_terminal,
    design_tracking_terminal,
)
from robust_core.verdict import Verdict

MODEL = TrackingError(period_s=0.2, speed_mps=(0.2, 0.4), yaw_rate_radps=0.6, heading_rad=0.3)
LIMITS = CommandLimits(speed_mps=(-0.4, 0.5), yaw_rate_radps=1.3, belt_mps=0.75, half_track_m=0.25)
WEIGHTS: dict[str, Any] = {"position": 20.0, "heading": 2.0, "speed": 1.0, "yaw_rate": 0.5}
SYSTEM = MODEL.system()


@pytest.fixture(scope="module")
def design() -> TerminalDesign:
    return design_tracking_terminal(MODEL, LIMITS, **WEIGHTS)


def starts(design: TerminalDesign, count: int, seed: int) -> Any:
    """Uniform in the terminal set."""
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    radii = rng.uniform(0.0, 1.0, (count, 1)) ** (1.0 / 3.0)
    return np.linalg.solve(np.linalg.cholesky(design.P).T, (directions * radii).T).T * np.sqrt(design.level)


def test_design_is_proven(design: TerminalDesign) -> None:
    assert design.result.verdict is Verdict.PROVEN
    assert design.level > 0.0
    weight, level = TerminalIngredient.level(design.result.require().values or {})
    assert weight == pytest.approx(design.P)
    assert level == pytest.approx(design.level)


def test_cost_descends_on_the_unicycle_itself_from_1000_starts(design: TerminalDesign) -> None:
    rng = np.random.default_rng(1)
    error = starts(design, 1000, seed=0)
    dv, dw, _ = LIMITS.room(MODEL)
    for _ in range(30):
        change = error @ design.K.T
        assert np.abs(change[:, 0]).max() <= dv
        assert np.abs(change[:, 1]).max() <= dw
        speed = rng.uniform(*MODEL.speed_mps, 1000)
        yaw_rate = rng.uniform(-MODEL.yaw_rate_radps, MODEL.yaw_rate_radps, 1000)
        after = MODEL.step(error, change, speed, yaw_rate)
        value, next_value = (np.einsum("ki,ij,kj->k", e, design.P, e) for e in (error, after))
        stage = error**2 @ np.array([20.0, 20.0, 2.0]) + change**2 @ np.array([1.0, 0.5])
        assert (next_value - value <= -stage).all()
        assert design.contains(after).all()
        error = after


@settings(max_examples=200, deadline=None, derandomize=True)
@given(
    error=st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(-0.25, 0.25)),
    change=st.tuples(st.floats(-0.1, 0.1), st.floats(-0.25, 0.25)),
    speed=st.floats(*MODEL.speed_mps),
    yaw_rate=st.floats(-0.6, 0.6),
    direction=st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)),
)
def test_vertices_enclose_every_step(error: Any, change: Any, speed: float, yaw_rate: float, direction: Any) -> None:
    e, u, d = np.array(error), np.array(change), np.array(direction)
    exact = MODEL.step(e, u, speed, yaw_rate)
    assert SYSTEM.B is not None
    vertices = SYSTEM.A @ e + SYSTEM.B @ u
    assert (vertices @ d).max() >= exact @ d - 1e-9


def test_error_frame_is_that_of_the_reference() -> None:
    e, u = np.array([0.3, -0.2, 0.1]), np.array([0.05, 0.2])
    pose, reference = np.array([0.3, -0.2, 0.1]), np.zeros(3)

    def drive(at: Any, v: float, w: float) -> Any:
        middle = at[2] + 0.5 * 0.2 * w
        return at + 0.2 * np.array([v * np.cos(middle), v * np.sin(middle), w])

    pose, reference = drive(pose, 0.35, 0.5), drive(reference, 0.3, 0.3)
    c, s = np.cos(reference[2]), np.sin(reference[2])
    gap = pose - reference
    expected = [c * gap[0] + s * gap[1], -s * gap[0] + c * gap[1], gap[2]]
    assert MODEL.step(e, u, 0.3, 0.3) == pytest.approx(expected, abs=1e-12)


def test_certificate_survives_a_file_and_no_larger_set_is_claimed(design: TerminalDesign, tmp_path: Path) -> None:
    certificate = design.result.require()
    path = save_certificate(certificate, tmp_path / "terminal.json")
    assert load_certificate(path, model=SYSTEM).feasible
    values = dict(certificate.values or {})
    values["w"] = values["w"] / 1.01
    with pytest.raises(ProofFailedError, match="limits"):
        type(certificate)(certificate.theorem, SYSTEM, values).verify()


def test_fast_layers_are_proven_too() -> None:
    model = TrackingError(period_s=1.0 / 30.0, speed_mps=(0.3, 0.35), yaw_rate_radps=0.2, heading_rad=0.2)
    assert design_tracking_terminal(model, LIMITS, **WEIGHTS).result.verdict is Verdict.PROVEN


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"speed_mps": (0.0, 0.4)}, "no terminal weight"),
        ({"speed_mps": (-0.2, 0.4)}, "no terminal weight"),
        ({"speed_mps": (0.4, 0.2)}, "range"),
        ({"period_s": 0.0}, "period_s"),
        ({"period_s": 5.0}, "turns"),
        ({"heading_rad": 2.0}, "heading_rad"),
        ({"yaw_rate_radps": float("nan")}, "yaw_rate"),
    ],
)
def test_references_without_a_terminal_weight_are_refused(change: Any, message: str) -> None:
    options: dict[str, Any] = {"period_s": 0.2, "speed_mps": (0.2, 0.4), "yaw_rate_radps": 0.6, "heading_rad": 0.3}
    with pytest.raises(ArgumentError, match=message):
        TrackingError(**{**options, **change})


def test_references_without_room_for_feedback_are_refused() -> None:
    fast = TrackingError(period_s=0.2, speed_mps=(0.2, 0.5), yaw_rate_radps=0.6, heading_rad=0.3)
    with pytest.raises(ArgumentError, match="room"):
        design_tracking_terminal(fast, LIMITS, **WEIGHTS)
    with pytest.raises(ArgumentError, match="increasing"):
        CommandLimits(speed_mps=(0.5, -0.4), yaw_rate_radps=1.3, belt_mps=0.75, half_track_m=0.25)


def test_straight_references_have_fewer_vertices() -> None:
    straight = TrackingError(period_s=0.2, speed_mps=(0.2, 0.4), yaw_rate_radps=0.0, heading_rad=0.3)
    assert straight.system().count == 24


PAIR = PolytopicSystem.of([[[1.0, 0.1], [0.0, 1.0]]], [[0.0], [0.1]])
LINES: dict[str, Any] = {"state_rows": [[0.0, 0.0]], "input_rows": [[1.0]], "bounds": [1.0]}


def test_plain_models_are_designed() -> None:
    design = design_terminal(PAIR, np.eye(2), [[1.0]], **LINES)
    assert design.result.verdict is Verdict.PROVEN


@pytest.mark.parametrize(
    "change",
    [
        {"Q": -np.eye(2)},
        {"Q": [[1.0, 0.5], [0.0, 1.0]]},
        {"R": [[0.0]]},
        {"bounds": [0.0]},
        {"bounds": [1.0, 1.0]},
        {"input_rows": [[1.0], [1.0]]},
        {"reserve": 0.0},
        {"model": PolytopicSystem.of([[[0.5]]])},
    ],
)
def test_malformed_requests_are_refused(change: Any) -> None:
    options = {"model": PAIR, "Q": np.eye(2), "R": [[1.0]], **LINES, **change}
    with pytest.raises(ArgumentError):
        design_terminal(**options)


def test_models_that_nothing_stabilises_give_an_error() -> None:
    model = PolytopicSystem.of([[[2.0, 0.0], [0.0, 0.5]]], [[0.0], [1.0]])
    with pytest.raises(SolverError):
        design_terminal(model, np.eye(2), [[1.0]], **LINES)


@pytest.mark.parametrize(
    "change",
    [{"gain": (("1",),)}, {"Q": (("1", "1"), ("0", "1"))}, {"bounds": ("1", "1")}, {"R": (("-1",),)}],
)
def test_claims_that_do_not_fit_are_refused(change: Any) -> None:
    options: dict[str, Any] = {
        "gain": (("1", "1"),),
        "Q": (("1", "0"), ("0", "1")),
        "R": (("1",),),
        "rows": (("1", "0"),),
        "bounds": ("1",),
    }
    with pytest.raises(ArgumentError):
        TerminalIngredient(**{**options, **change}).specialised(PAIR)
    with pytest.raises(ArgumentError, match="inputs"):
        TerminalIngredient(**options).specialised(PolytopicSystem.of([[[0.5]]]))
