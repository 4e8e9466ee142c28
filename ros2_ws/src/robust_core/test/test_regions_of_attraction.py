"""Certified regions of attraction, and sweeps that are interrupted."""

import json
import math

import numpy as np
import pytest

from robust_core.analysis import certified_region, decide, maximised_region, sweep
from robust_core.analysis.sweep import SweepFileError
from robust_core.errors import ArgumentError, NotProvenError, ProofFailedError
from robust_core.models import PolytopicSystem
from robust_core.plants import example_2_4_1
from robust_core.theorems import CommonLyapunov, ParameterDependent, Relaxed, TensorProduct
from robust_core.verdict import Verdict

BOX = [math.pi / 2] * 2
MODEL = example_2_4_1.Family(math.pi / 2)(np.array([[-14.0, 100.0]]))[0]


def simulate(states: np.ndarray, alpha: float, beta: float, seconds: float) -> tuple[np.ndarray, np.ndarray]:
    """Final states and largest magnitudes of (2.4.1) from many starts (2, N)."""

    def flow(x):
        s = np.sin(x[0]) + np.sin(x[1])
        upper = (-3.5 + 0.25 * s) * x[0] - 4.0 * x[1]
        lower = (0.5 * (beta - 1) + 0.15 * (beta + 1) * s) * x[0] + (0.5 * (alpha - 2) - 0.1 * (alpha + 2) * s) * x[1]
        return np.array([upper, lower])

    step, largest = 1e-3, np.abs(states)
    for _ in range(round(seconds / step)):
        k1 = flow(states)
        k2 = flow(states + 0.5 * step * k1)
        k3 = flow(states + 0.5 * step * k2)
        states = states + step / 6.0 * (k1 + 2 * k2 + 2 * k3 + flow(states + step * k3))
        largest = np.maximum(largest, np.abs(states))
    return states, largest


@pytest.mark.parametrize("theorem", [Relaxed(), TensorProduct()])
@pytest.mark.parametrize("grow", [certified_region, None], ids=["certified", "maximised"])
def test_motions_from_the_region_stay_in_the_box_and_reach_the_origin(theorem, grow) -> None:
    certificate = decide(theorem, MODEL).require()
    region = maximised_region(theorem, MODEL, BOX) if grow is None else grow(certificate, BOX)
    region.verify()
    rng = np.random.default_rng(5)
    starts = []
    for P in region.inner:
        root = np.linalg.inv(np.linalg.cholesky(P)).T * math.sqrt(region.level)
        directions = rng.normal(size=(2, 500))
        starts.append(root @ (directions / np.linalg.norm(directions, axis=0)))
    every = np.hstack(starts)
    values = np.einsum("ix,kij,jx->kx", every, region.inner, every)
    inside = every[:, (values <= region.level * (1 + 1e-9)).all(axis=0)]
    assert inside.shape[1] > 50
    final, largest = simulate(inside, -14.0, 100.0, 3.0)
    assert (largest <= math.pi / 2).all()
    assert np.abs(final).max() < 1e-2


def test_a_larger_level_fails_its_proof() -> None:
    region = certified_region(decide(Relaxed(), MODEL).require(), BOX)
    from dataclasses import replace

    with pytest.raises(ProofFailedError, match="faces"):
        replace(region, level=1.01 * region.level).verify()


def test_a_maximised_region_is_larger() -> None:
    model = PolytopicSystem.of([[[-1.0, 0.0], [0.0, -1.0]], [[-1.0, 0.3], [0.0, -2.0]]])
    first = certified_region(decide(CommonLyapunov(), model).require(), [1.0, 3.0])
    better = maximised_region(CommonLyapunov(), model, [1.0, 3.0])

    def area(region) -> float:
        return region.level / math.sqrt(np.linalg.det(region.inner[0]))

    assert area(better) > 1.2 * area(first)
    assert area(better) == pytest.approx(3.0, rel=0.05)


def test_regions_need_a_solution_and_a_box() -> None:
    with pytest.raises(NotProvenError, match="infeasible"):
        maximised_region(CommonLyapunov(), PolytopicSystem.of([np.eye(2)]), [1.0, 1.0])
    certificate = decide(Relaxed(), MODEL).require()
    for bad in ([1.0], [1.0, 0.0], [1.0, -1.0], [1.0, math.inf]):
        with pytest.raises(ArgumentError, match="half_widths"):
            certified_region(certificate, bad)


def family(points: np.ndarray) -> list[PolytopicSystem]:
    """Scalar systems x' = -p x; p <= 0 is not stable."""
    return [PolytopicSystem.of([[[-p]]], rates=[0.0]) for p in points[:, 0].tolist()]


class Interrupted(Exception):
    """Stands for a user who stops a sweep."""


def test_sweeps_go_on_where_they_stopped(tmp_path) -> None:
    points, file = np.linspace(-1.0, 1.0, 1100)[:, None], tmp_path / "sweep.jsonl"

    def stop(done: int, _: int) -> None:
        if done > 600:
            raise Interrupted

    with pytest.raises(Interrupted):
        sweep([CommonLyapunov(), ParameterDependent()], family, points, workers=1, file=file, progress=stop)
    with file.open("a") as stream:
        stream.write('{"start": 512, "verd')
    seen = []
    found = sweep(
        [CommonLyapunov(), ParameterDependent()],
        family,
        points,
        workers=1,
        file=file,
        progress=lambda done, total: seen.append((done, total)),
    )
    assert seen[0][0] > 600
    assert seen[-1] == (2200, 2200)
    again = sweep([CommonLyapunov(), ParameterDependent()], family, points, workers=1, file=file)
    for row in range(2):
        assert ((found.verdicts[row] == Verdict.PROVEN) == (points[:, 0] > 0.0)).all()
        assert (found.verdicts[row] == again.verdicts[row]).all()


def test_sweeps_on_several_processes_say_the_same() -> None:
    points = example_2_4_1.grid(24)
    model_family = example_2_4_1.Family(math.pi / 40)
    single = sweep([CommonLyapunov()], model_family, points, workers=1)
    several = sweep([CommonLyapunov()], model_family, points, workers=2)
    assert (single.verdicts == several.verdicts).all()


def broken_family(points: np.ndarray) -> list[PolytopicSystem]:
    """A family that cannot make its models."""
    raise ZeroDivisionError("no models")


def test_errors_of_a_family_reach_the_caller() -> None:
    with pytest.raises(ZeroDivisionError, match="no models"):
        sweep([CommonLyapunov()], broken_family, np.ones((2, 1)), workers=1)


def test_sweep_files_of_other_sweeps_or_with_damage_are_refused(tmp_path) -> None:
    points, file = np.array([[1.0], [2.0]]), tmp_path / "sweep.jsonl"
    sweep([CommonLyapunov()], family, points, workers=1, file=file)
    with pytest.raises(SweepFileError, match="another sweep"):
        sweep([CommonLyapunov()], family, points + 1.0, workers=1, file=file)
    lines = file.read_text().splitlines()
    file.write_text("\n".join(["{", *lines]))
    with pytest.raises(SweepFileError, match="line 1"):
        sweep([CommonLyapunov()], family, points, workers=1, file=file)
    assert json.loads(lines[0])["sweep"]


def test_points_that_cannot_be_asked_are_undecided_with_the_reason() -> None:
    from robust_core.analysis import decide_many

    models = [PolytopicSystem.of([-np.eye(2)]), PolytopicSystem.of([-np.eye(2)], rates=[0.1])]
    results = decide_many(ParameterDependent(), models)
    assert [result.verdict for result in results] == [Verdict.UNDECIDED, Verdict.PROVEN]
    assert "RateError" in results[0].reason


@pytest.mark.parametrize("points", [[], [[math.nan]], [1.0]])
def test_malformed_points_are_refused(points) -> None:
    with pytest.raises(ArgumentError, match="points"):
        sweep([CommonLyapunov()], family, points)
    with pytest.raises(ArgumentError, match="theorems"):
        sweep([], family, [[1.0]])
