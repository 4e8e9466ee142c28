"""``design``: gains, filters and observers with the proof of what they do."""

from typing import Any

import numpy as np

from robust_core.command_line.choices import index_of, region_of
from robust_core.command_line.fields import Fields, SpecError
from robust_core.command_line.outcome import Outcome
from robust_core.command_line.plots import draw_gains, draw_poles
from robust_core.command_line.spec import Spec
from robust_core.command_line.systems import filter_plant, lipschitz_plant, polytopic

STABILISE = ("method", "decay", "input_limit", "box", "start", "objective", "region", "gain_bound", "digits",
             "rates_hold_in_closed_loop")  # fmt: skip
FREQUENCIES = np.logspace(-2.0, 4.0, 400)


def design(spec: Spec) -> Outcome:
    """The design that a specification asks for."""
    return {"stabilise": _stabilise, "filter": _filter, "observer": _observer}[spec.task](spec.system, spec.asked)


def _stabilise(system: Fields, asked: Fields) -> Outcome:
    from robust_core.stabilisation import Request, design_dependent, design_quadratic

    asked.only(*STABILISE)
    method = asked.text("method", "quadratic", ("quadratic", "dependent"))
    decay, region = asked.number("decay", 0.0), region_of(asked)
    digits = asked.whole("digits", 7, low=2, high=17)
    model, formulas = polytopic(system)
    words = [f"vertex gains u = sum_j sigma_j K_j x for {model.states} states and {model.count} vertices"]
    words.append(f"decay of at least {decay:g} 1/s")
    if method == "dependent":
        for name in ("input_limit", "box", "start", "objective", "region"):
            if asked.has(name):
                raise SpecError(asked.key(name), "is for method quadratic: limits take one ellipsoid")
        words.append("a Lyapunov function that depends on the weights (design D)")
        with asked.about():
            found = design_dependent(
                model,
                rates_hold_in_closed_loop=asked.content.get("rates_hold_in_closed_loop") is True,
                decay=decay,
                gain_bound=asked.number("gain_bound") if asked.has("gain_bound") else None,
                digits=digits,
            )
    else:
        for name in ("gain_bound", "rates_hold_in_closed_loop"):
            if asked.has(name):
                raise SpecError(asked.key(name), "is for method dependent")
        limits, more = _limits(asked, formulas.states if formulas else [str(k) for k in range(model.states)])
        with asked.about():
            objective: Any = asked.text("objective", "small gains")
            request = Request(decay=decay, region=region, digits=digits, objective=objective, **limits)
            found = design_quadratic(model, request)
        words += more + ([f"frozen poles in {region.name}"] if region else [])
    certificate = found.result.certificate
    loop = _loop(model, found.K)
    notes = []
    if certificate is not None and getattr(certificate.theorem, "limited", False):
        P = found.ellipsoid()
        peak = float(np.sqrt(np.einsum("mri,ij,mrj->mr", found.K, np.linalg.inv(P), found.K).max()))
        reach = ", ".join(f"{half:.4g}" for half in np.sqrt(np.diag(np.linalg.inv(P))))
        notes.append(f"the ellipsoid x'P x <= 1 is never left; its half widths are {reach}")
        notes.append(f"inside it the input stays below {peak:.4g}: it never saturates")
    notes.append(f"slowest frozen pole: real part {float(np.linalg.eigvals(loop).real.max()):.4g} 1/s")
    if formulas is not None and not asked.has("box"):
        notes.append(
            "the model holds inside its box only: limit the states (box) for a claim that says they stay there"
        )
    return Outcome(
        found.result.verdict,
        found.result.reason,
        tuple(words),
        tuple(notes),
        certificate,
        {"K": found.K},
        lambda figure: draw_poles(
            figure, {"open loop, vertices": model.A, "closed loop, vertices": loop}, region=region, decay=decay
        ),
        open_loop=model if method == "dependent" else None,
    )


def _limits(asked: Fields, states: Any) -> tuple[dict[str, Any], list[str]]:
    limits: dict[str, Any] = {}
    words = []
    if asked.has("input_limit"):
        several = isinstance(asked.content["input_limit"], list)
        limits["input_limit"] = asked.floats("input_limit") if several else np.array([asked.number("input_limit")])
        if limits["input_limit"].ndim != 1:
            raise SpecError(asked.key("input_limit"), "must be a number, or a list of one per input")
        words.append(f"|u| below {', '.join(f'{v:g}' for v in limits['input_limit'])} for ever")
    if asked.has("box"):
        box = asked.part("box")
        box.only(*states)
        limits["box"] = {states.index(name): box.number(name) for name in box.content}
        words.append("; ".join(f"|{name}| below {box.number(name):g} for ever" for name in box.content))
    if asked.has("start"):
        limits["start"] = asked.floats("start")
        if limits["start"].ndim != 2:
            raise SpecError(asked.key("start"), "must be a list of points, each a list of states")
        words.append(f"all of that from {len(limits['start'])} start points and their hull")
    return limits, words


def _loop(model: Any, K: Any) -> Any:
    if np.equal(model.B, model.B[0]).all():
        return model.A + model.B @ K
    first, second = np.triu_indices(len(K))
    one, other = model.A[first] + model.B[first] @ K[second], model.A[second] + model.B[second] @ K[first]
    return 0.5 * (one + other)


def _filter(system: Fields, asked: Fields) -> Outcome:
    from robust_core.filtering import design_filter, design_finite_frequency, error_gain, error_poles_model

    asked.only("index", "order", "region", "fastest_pole", "digits", "band")
    plant, region = filter_plant(system), region_of(asked)
    sizes, digits = plant.sizes, asked.whole("digits", 9, low=2, high=17)
    if asked.has("band"):
        for name in ("index", "order", "fastest_pole"):
            if asked.has(name):
                raise SpecError(asked.key(name), "does not go with band: the gain in it is made small, at full order")
        band = asked.floats("band")
        if band.shape != (2,):
            raise SpecError(asked.key("band"), "must be [low, high] in rad/s")
        with asked.about():
            one = design_finite_frequency(plant, (float(band[0]), float(band[1])), region=region, digits=digits)
        filtering, level, result, best = one.filtering, one.gamma, one.result, one.grid_gamma
        goal = f"the smallest gain from w to the error for {band[0]:g} to {band[1]:g} rad/s, frozen weights"
        name = "gain in the band"
    else:
        index = index_of(asked, sizes["z"], sizes["w"])
        with asked.about():
            design_of = design_filter(
                plant,
                index,
                order=asked.whole("order", low=1) if asked.has("order") else None,
                region=region,
                fastest_pole=asked.number("fastest_pole") if asked.has("fastest_pole") else None,
                digits=digits,
            )
        assert design_of.analysis is not None
        filtering, level, result = design_of.filtering, design_of.analysis.figure, design_of.analysis.result
        best, name = design_of.optimum, f"{index.figure} ({index.name})"
        goal = f"the best {name} of the estimate of z, for weights that vary in any way"
    words = [f"a filter of order {filtering.order} for a plant of {plant.count} vertices", goal]
    words += [f"frozen poles of the error in {region.name}"] if region else []
    A, B, C = filtering.matrices()
    gains = error_gain(plant, filtering, FREQUENCIES)

    def draw(figure: Any) -> None:
        left, right = figure.subfigures(1, 2)
        draw_gains(left, FREQUENCIES, gains, level, f"{name}: {level:.4g}", "rad/s")
        draw_poles(right, {"plant": plant.data()["A"], "error": error_poles_model(plant, filtering).A}, region=region)

    found = (
        f"{name} proven: {level:.6g}, of {best:.6g} that the solver sees at best",
        f"largest gain on a grid of frequencies: {float(gains.max()):.6g}",
    )
    gained = {"A": A, "B": B, "C": C}
    return Outcome(
        result.verdict, result.reason, tuple(words), found, result.certificate, gained, draw, size_in=(11.0, 4.2)
    )


def _observer(system: Fields, asked: Fields) -> Outcome:
    from robust_core.observers import design_observer

    asked.only("tau", "pole", "rho")
    plant = lipschitz_plant(system)
    tau = asked.number("tau")
    with asked.about():
        made = design_observer(
            plant, tau, pole=asked.number("pole") if asked.has("pole") else None, rho=asked.number("rho", 1.0)
        )
    frequencies = np.logspace(-4.0, np.log10(np.pi), 300)
    gain = made.observer.fault_gain(plant, frequencies)
    matrices = made.observer.matrices(plant)

    def draw(figure: Any) -> None:
        left, right = figure.subfigures(1, 2)
        draw_gains(left, frequencies, gain[None], float("nan"), "", "rad/step")
        draw_poles(right, {"plant": plant.data()["A"], "observer": matrices["N"]}, discrete=True)

    return Outcome(
        made.result.verdict,
        made.result.reason,
        (
            f"a fault-detection observer for every f with |f(a) - f(b)| <= {tau:g} |a - b| in the 2-norm of the states",
            "a residual that depends on the fault",
        ),
        (f"pole {made.pole:.6g}", f"gain from the fault to the residual at rest: {float(gain[0]):.6g}"),
        made.result.certificate,
        {"E": matrices["E"], "X": matrices["X"]},
        draw,
        size_in=(11.0, 4.2),
    )
