"""Designs of robust_core on the thesis's examples: gains, filters, observers, terminal weights, and their proofs.

Every figure comes with a certificate that was verified in exact arithmetic, or is the outcome of a simulation of the
nonlinear plant. Times are thread CPU time.
"""

import argparse
import json
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from robust_design_runs import (
    LIMIT_A,
    filter_errors,
    limit_cycle,
    open_loop,
    stabilise,
    synchronise,
)
from robust_design_terminal import upper_terminal_figures

from robust_core.certificates import Certificate, load_certificate, save_certificate
from robust_core.errors import CertificateError
from robust_core.filtering import (
    Filter,
    analyse_filter,
    band_gain,
    certify_band,
    design_filter,
    design_finite_frequency,
    dissipative,
    energy_to_peak,
    h_infinity,
    limit_of_filters,
    passive,
)
from robust_core.lmi.settings import SolverSettings
from robust_core.models import FilterPlant
from robust_core.observers import FaultObserver, design_observer, largest_tau, supremum_tau
from robust_core.plants import chua, tunnel_diode
from robust_core.plants.vibration_sensor import VibrationSensor
from robust_core.rational import exact_array, to_float
from robust_core.stabilisation import Request, design_dependent, design_quadratic, refute_printed
from robust_core.theorems.regions import disc
from robust_core.verdict import Verdict
from tracked_report.results import write_metrics

SEED = 6
DISC = disc(-20.0, 19.9)
Values = dict[str, float]
PROOFS: dict[str, Certificate] = {}


def proven(name: str, result: Any) -> float:
    """1 where the result is proven, whose certificate is kept for the test of corruption; else 0."""
    if result.verdict is Verdict.PROVEN:
        PROOFS[name] = result.certificate
    return float(result.verdict is Verdict.PROVEN)


def median_ms(work: Callable[[], Any], repeats: int) -> float:
    """Median thread CPU time (ms) after one call that warms up."""
    work()
    times = []
    for _ in range(repeats):
        begun = time.thread_time()
        work()
        times.append(1e3 * (time.thread_time() - begun))
    return statistics.median(times)


def chua_figures(quick: bool) -> Values:
    """Designs Q, S and D against the printed gains, from t = 20 s on and with the source's limit of 10 A."""
    step = 1e-3 if quick else 5e-4
    states = open_loop(step)
    model, error = chua.stabilisation(), chua.synchronisation()
    request = Request(
        decay=0.3, input_limit=LIMIT_A, box={1: chua.BOX}, start=limit_cycle(states, step), objective="large set"
    )
    s, q = design_quadratic(model, request), design_quadratic(error, Request())
    d, e = (design_dependent(m, rates_hold_in_closed_loop=True) for m in (model, error))
    values = {f"chua.{n}.proven": proven(f"chua {n}", r.result) for n, r in zip("sqde", (s, q, d, e), strict=True)}
    values["chua.s.decay"] = request.decay
    values["chua.s.guaranteed_peak_a"] = _ellipsoid_peak(s.ellipsoid(), s.K)
    printed = to_float(exact_array(chua.PRINTED_STABILISATION_GAINS))
    printed_error = to_float(exact_array(chua.PRINTED_SYNCHRONISATION_GAINS))
    duration = 10.5
    runs = dict(zip(("printed", "s", "d"), stabilise([printed, s.K, d.K], states, duration, step), strict=True))
    runs |= dict(
        zip(("printed_sync", "q", "e"), synchronise([printed_error, q.K, e.K], states, duration, step), strict=True)
    )
    for name, run in runs.items():
        values[f"chua.{name}.settle_s"] = run.settle_s
        values[f"chua.{name}.peak_a"] = run.peak_a
        values[f"chua.{name}.last_at_limit_s"] = run.last_limit_s
    refuted = [
        refute_printed(m, growth=growth, z=z).verdict is Verdict.INFEASIBLE
        for m in (model, error)
        for z in range(4)
        for growth in ("1/1000", 1, 1000)
    ]
    refuted_once = refute_printed(model).certificate
    assert refuted_once is not None
    PROOFS["printed 2.4"] = refuted_once
    return values | {"chua.printed_theorem_refuted_share": float(np.mean(refuted))}


def _ellipsoid_peak(P: Any, K: Any) -> float:
    """The largest |u| that the invariant ellipsoid allows."""
    return float(np.sqrt(np.einsum("mri,ij,mrj->mr", K, np.linalg.inv(P), K).max()))


def tunnel_figures(quick: bool) -> Values:
    """Optima of Theorem 3.2 on printed and true vertices, what is proven of them, and what they cost."""
    plants = {"printed": tunnel_diode.tunnel_diode(), "true": tunnel_diode.tunnel_diode().attained()}
    indices = {
        "h_infinity": h_infinity(),
        "energy_to_peak": energy_to_peak(),
        "passive": passive(),
        "dissipative": dissipative(-1, 1, 0),
    }
    values: Values = {}
    for plant_name, plant in plants.items():
        for name, index in indices.items():
            design = design_filter(plant, index, region=DISC)
            assert design.analysis is not None
            values[f"tunnel.{name}.{plant_name}.proven"] = proven(f"{name} {plant_name}", design.analysis.result)
            values[f"tunnel.{name}.{plant_name}.figure"] = design.analysis.figure
            values[f"tunnel.{name}.{plant_name}.optimum"] = design.optimum
        reduced = design_filter(plant, h_infinity(), region=DISC, order=1)
        assert reduced.analysis is not None
        values[f"tunnel.reduced_order.{plant_name}.figure"] = reduced.analysis.figure
    printed = analyse_filter(plants["printed"], _printed_filter(), h_infinity(), region=DISC)
    values["tunnel.printed_filter.figure"] = printed.figure
    values["tunnel.printed_filter.proven"] = proven("printed filter", printed.result)
    repeats = 5 if quick else 21
    plant = plants["printed"]
    values["synthesis.tunnel_ms"] = median_ms(
        lambda: design_filter(plant, h_infinity(), region=DISC, certify=False), repeats
    )
    values["synthesis.tunnel_with_proof_ms"] = median_ms(
        lambda: design_filter(plant, h_infinity(), region=DISC), repeats
    )
    large, patient = _random_plant(8, 16), SolverSettings(time_limit_s=600.0)
    for key, region in (("no_region", None), *(() if quick else (("region", DISC),))):
        begun = time.thread_time()
        design_filter(large, h_infinity(), region=region, fastest_pole=100.0, certify=False, settings=patient)
        values[f"synthesis.n8_m16_{key}_s"] = time.thread_time() - begun
    return values


def _printed_filter() -> Filter:
    parts = tunnel_diode.PRINTED_FILTER
    return Filter.of(parts["A"], parts["B"], parts["C"])


def _random_plant(states: int, vertices: int) -> FilterPlant:
    rng = np.random.default_rng(SEED)
    center = -3.0 * np.eye(states) + 0.5 * rng.normal(size=(states, states))
    return FilterPlant.of(
        A=center + 0.1 * rng.normal(size=(vertices, states, states)),
        B=rng.normal(size=(states, 1)),
        C=rng.normal(size=(1, states)),
        E=rng.normal(size=(1, states)),
        F=[[0.5]],
    )


def finite_frequency_figures(quick: bool) -> Values:
    """Filters for bands of +-20 % about 2 pi and 60 pi rad/s, on the true vertices, against the full-band filter.

    ``limit``: a gain that no linear filter can go below in the band, whatever its design.
    """
    plant = tunnel_diode.tunnel_diode().attained()
    full = design_filter(plant, h_infinity(), region=DISC)
    assert full.analysis is not None
    values: Values = {}
    for name, center, ratios in (("slow", 2.0 * np.pi, (1.0, 3.0)), ("fast", 60.0 * np.pi, (0.2,))):
        band = (0.8 * center, 1.2 * center)
        design = design_finite_frequency(plant, band, region=DISC, ratios=ratios[:1] if quick else ratios)
        of_full = certify_band(plant, full.filtering, band, region=DISC)
        stem = f"finite_frequency.{name}"
        values[f"{stem}.proven"] = proven(f"band {name}", design.result)
        values[f"{stem}.gain"] = design.gamma
        values[f"{stem}.grid_gain"] = design.grid_gamma
        values[f"{stem}.full_band_gain_in_band"] = of_full.gamma
        values[f"{stem}.full_band_certified_gain"] = full.analysis.figure
        values[f"{stem}.limit"] = max(limit_of_filters(plant, w) for w in np.linspace(*band, 9))
        values[f"{stem}.below_in_band"] = 1.0 - design.gamma / band_gain(plant, full.filtering, band)
        values[f"{stem}.below_certified"] = 1.0 - design.gamma / full.analysis.figure
        values[f"{stem}.possible_in_band"] = 1.0 - values[f"{stem}.limit"] / band_gain(plant, full.filtering, band)
        errors = filter_errors([design.filtering, full.filtering], center, seed=SEED, step=1e-3 if quick else 5e-4)
        for column, which in enumerate(("designed", "full_band")):
            values[f"{stem}.simulated_{which}_frozen"] = float(errors[:3, column].max())
            values[f"{stem}.simulated_{which}_varying"] = float(errors[3:, column].max())
        values[f"{stem}.below_simulated"] = 1.0 - float(errors[:3, 0].max() / errors[:3, 1].max())
    return values


def observer_figures(quick: bool) -> Values:
    """Suprema of the admissible Lipschitz constant, and designs that are proven and not blind."""
    grid = [VibrationSensor(mass_kg=m, spring_npm=k) for m in (0.18, 0.21, 0.25) for k in (380.0, 390.0, 400.0)]
    suprema = [supremum_tau(sensor.plant()) for sensor in (grid[::4] if quick else grid)]
    plant = VibrationSensor().plant()
    E = np.array([["-0.9153"], ["-681.5633"]], dtype=object)
    M = np.eye(2) + to_float(exact_array(E)) @ plant.data()["C"]
    identified = VibrationSensor(joint_damping_nms=0.0518).plant()
    X = (M @ identified.data()["A"])[:, :1] - np.array([[0.0], [-2e-4]])
    design = design_observer(plant, 80.0)
    return {
        "observer.supremum_min": min(suprema),
        "observer.supremum_max": max(suprema),
        "observer.printed": largest_tau(identified, FaultObserver.of(E, X)),
        "observer.young_1": supremum_tau(plant, young=1.0),
        "observer.young_01": supremum_tau(plant, young=0.1),
        "observer.luenberger": supremum_tau(plant, luenberger=True),
        "observer.tau80.proven": proven("observer", design.result),
        "observer.tau80.pole": design.pole,
        "observer.tau80.fault_gain": float(design.observer.fault_gain(plant, 1e-6)),
        "observer.tau700.proven": proven("observer 703", design_observer(plant, 703.5384).result),
    }


def terminal_figures(quick: bool) -> Values:
    """Terminal weight and set of the upper layer, see there."""
    values, result = upper_terminal_figures(10 if quick else 60, SEED)
    return values | {"terminal.proven": proven("terminal", result)}


def corruption_figures(quick: bool) -> Values:
    """Certificates of all kinds, each with one digit changed at random: how many are still accepted."""
    rng = np.random.default_rng(SEED)
    tried = accepted = 0
    with tempfile.TemporaryDirectory() as folder:
        for number, certificate in enumerate(PROOFS.values()):
            path = save_certificate(certificate, Path(folder) / f"{number}.json")
            load_certificate(path, model=certificate.model)
            text = path.read_text(encoding="utf-8")
            places = [k for k, letter in enumerate(text) if letter.isdigit()]
            for _ in range(5 if quick else 60):
                k = places[int(rng.integers(len(places)))]
                digit = str((int(text[k]) + int(rng.integers(1, 10))) % 10)
                path.write_text(text[:k] + digit + text[k + 1 :], encoding="utf-8")
                tried += 1
                try:
                    load_certificate(path, verify=False)
                except CertificateError:
                    continue
                accepted += json.loads(path.read_text(encoding="utf-8")) != json.loads(text)
    return {
        "corruption.certificates": float(len(PROOFS)),
        "corruption.tried": float(tried),
        "corruption.rejected_share": 1.0 - accepted / tried,
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="coarser simulations and fewer repeats")
    quick = parser.parse_args().quick
    values: Values = {}
    parts = (
        chua_figures,
        tunnel_figures,
        finite_frequency_figures,
        observer_figures,
        terminal_figures,
        corruption_figures,
    )
    for part in parts:
        begun = time.thread_time()
        found = part(quick)
        print(f"{part.__name__} ({time.thread_time() - begun:.1f} s)")
        for key, value in found.items():
            print(f"  {key:52} {value:12.6g}")
        values |= found
    print(write_metrics("robust_design", values, seed=SEED))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
