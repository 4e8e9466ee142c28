"""``certify``: what can be proven of a system, of given gains, of a given filter or observer."""

from typing import Any

from robust_core.analysis import certified_region, decide, largest_decay
from robust_core.command_line.choices import index_of, region_of, theorem_of
from robust_core.command_line.fields import Fields, SpecError
from robust_core.command_line.outcome import Outcome
from robust_core.command_line.plots import draw_poles
from robust_core.command_line.spec import Spec
from robust_core.command_line.systems import filter_plant, lipschitz_plant, polytopic
from robust_core.verdict import Verdict


def certify(spec: Spec) -> Outcome:
    """The proof that a specification asks for."""
    asked = spec.asked
    kinds = [kind for kind in ("filter", "observer") if asked.has(kind)]
    if len(kinds) == 2:
        raise SpecError(asked.key("filter"), "or observer, not both")
    return {"filter": _filter, "observer": _observer, "": _stability}["".join(kinds)](spec.system, asked)


def _stability(system: Fields, asked: Fields) -> Outcome:
    asked.only("theorem", "decay", "gains", "region", "input_limit", "box_rows", "half_widths")
    model, _ = polytopic(system)
    largest = asked.content.get("decay") == "largest"
    decay = 0.0 if largest else asked.number("decay", 0.0)
    words = [f"{model.states} states and {model.count} vertices"]
    if asked.has("gains"):
        with asked.about("gains"):
            loop = model.closed_loop(asked.array("gains"))
        words.append("the loop closed by the given vertex gains")
    else:
        loop = model
    region = region_of(asked)
    if region is not None:
        from robust_core.theorems import DStability

        if asked.has("theorem") or asked.has("decay"):
            raise SpecError(asked.key("region"), "is a claim of its own about frozen poles: ask for it alone")
        result = decide(DStability.within(region), loop)
        notes: list[str] = []
        words.append(f"poles of every frozen system in {region.name}")
    else:
        name = asked.text("theorem", "2.1")
        theorem = theorem_of(name, asked.key("theorem"))(decay=decay)
        words.append(f"stability by theorem {name}, {'the largest decay' if largest else f'decay {decay:g} 1/s'}")
        if largest:
            decay, result = largest_decay(theorem, loop)
            notes = [f"largest proven decay: {decay:.5g} 1/s"]
        else:
            result, notes = decide(theorem, loop), []
    if asked.has("half_widths") and result.certificate is not None and result.certificate.feasible:
        with asked.about("half_widths"):
            attraction = certified_region(result.certificate, asked.floats("half_widths"))
        attraction.verify()
        notes.append(f"V < {attraction.level:.6g} inside the box is never left and goes to the origin")
    groups = {"open loop, vertices": model.A} | ({"closed loop, vertices": loop.A} if asked.has("gains") else {})
    return Outcome(
        result.verdict,
        result.reason,
        tuple(words),
        tuple(notes),
        result.certificate,
        draw=lambda figure: draw_poles(figure, groups, region=region, decay=decay),
    )


def _filter(system: Fields, asked: Fields) -> Outcome:
    from robust_core.filtering import Filter, analyse_filter, error_poles_model

    asked.only("filter", "index", "region")
    plant, region, given = filter_plant(system), region_of(asked), asked.part("filter")
    given.only("A", "B", "C")
    with given.about():
        filtering = Filter.of(*(given.array(name) for name in "ABC"))
    index = index_of(asked, plant.sizes["z"], plant.sizes["w"])
    with asked.about():
        found = analyse_filter(plant, filtering, index, region=region)
    A, B, C = filtering.matrices()
    return Outcome(
        found.result.verdict,
        found.result.reason,
        (f"the best {index.figure} ({index.name}) that theorem 3.1 proves of the given filter",),
        (f"{index.figure} proven: {found.figure:.6g}",),
        found.result.certificate,
        {"A": A, "B": B, "C": C},
        lambda figure: draw_poles(
            figure, {"plant": plant.data()["A"], "error": error_poles_model(plant, filtering).A}, region=region
        ),
    )


def _observer(system: Fields, asked: Fields) -> Outcome:
    from robust_core.observers import FaultObserver, LipschitzObserver, largest_tau

    asked.only("observer", "tau")
    plant, given = lipschitz_plant(system), asked.part("observer")
    given.only("E", "X")
    with given.about():
        observer = FaultObserver.of(given.array("E"), given.array("X"))
    tau: Any = asked.number("tau")
    with asked.about():
        result = decide(LipschitzObserver(observer, repr(tau)), plant)
    notes = (
        []
        if result.verdict is Verdict.PROVEN
        else [f"largest tau of this observer: {largest_tau(plant, observer):.6g}"]
    )
    matrices = observer.matrices(plant)
    return Outcome(
        result.verdict,
        result.reason,
        (f"convergence of the given observer for the Lipschitz constant {tau:g}, with a residual that is not blind",),
        tuple(notes),
        result.certificate,
        {"E": matrices["E"], "X": matrices["X"]},
        lambda figure: draw_poles(figure, {"plant": plant.data()["A"], "observer": matrices["N"]}, discrete=True),
    )
