"""Figures 2.6 to 2.12: Chua's oscillator, open loop, brought to rest, and synchronised."""

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from robust_core.analysis import largest_decay
from robust_core.plants import chua, chua_formulas
from robust_core.rational import exact_array, to_float
from robust_core.stabilisation import Request, design_quadratic, refute_printed
from robust_core.theorems import CommonLyapunov
from robust_core.verdict import Verdict
from tracked_lab.gallery.entry import Check, Drawing, Entry, Label, close, exactly, holds
from tracked_lab.gallery.integrate import Array, runge_kutta

SWITCH_S, STOP_S, LIMIT_A, PERIOD_S = 20.0, 32.0, 10.0, 1.8015
STATES = ("x1 (V)", "x2 (V)", "x3 (A)")
BLUE, RED, GREEN, GREY = "#0072b2", "#d55e00", "#009e73", "#9aa5b1"


@lru_cache(maxsize=2)
def _open_loop(step: float) -> Array:
    start = np.array([[-0.1, -0.1, 0.1], [0.1, 0.1, -0.1]])
    return runge_kutta(lambda _, x: chua.derivative(x), start, 0.0, SWITCH_S + PERIOD_S, step)


def _step(quick: bool) -> float:
    return 2e-3 if quick else 5e-4


def limit_cycle(quick: bool) -> Entry:
    """Figures 2.6 and 2.7."""
    step = _step(quick)
    states = _open_loop(step)[:, 0]
    cycle = states[round(12.0 / step) :]
    peaks = np.abs(cycle).max(axis=0)
    crossings = np.flatnonzero((cycle[:-1, 0] < 0.0) & (cycle[1:, 0] >= 0.0)) * step
    times = np.arange(len(states)) * step
    checks = (
        close("largest |x1| on the cycle", peaks[0], 1.754, 2e-3, unit="V"),
        close("largest |x2| on the cycle", peaks[1], 1.906, 2e-3, unit="V"),
        close("largest |x3| on the cycle", peaks[2], 6.984, 2e-3, unit="A"),
        close("period", float(np.diff(crossings).mean()), PERIOD_S, 2e-3, unit="s"),
    )

    def draw(drawn: Any) -> None:
        left, right = drawn.subfigures(1, 2, width_ratios=(3, 2))
        axes = left.subplots(3, 1, sharex=True)
        for ax, name, values in zip(axes, STATES, states.T, strict=True):
            ax.plot(times, values, color=BLUE, lw=1)
            ax.set_ylabel(name)
        axes[-1].set_xlabel("t (s)")
        space = right.add_subplot(projection="3d")
        space.plot(*states[: round(12.0 / step)].T, color=GREY, lw=0.5)
        space.plot(*cycle.T, color=BLUE, lw=1.6)
        space.set(xlabel=STATES[0], ylabel=STATES[1], zlabel=STATES[2])

    return Entry(
        "Figs 2.6, 2.7",
        "Chua's oscillator without control",
        Label.REPRODUCED,
        "From x(0) = (-0.1, -0.1, 0.1) the states settle on a limit cycle. The current leaves ±6, which does no harm: "
        "the model's weights depend on x2 alone.",
        checks,
        (Drawing("States and limit cycle", "Right: the way to the cycle grey, the cycle blue.", draw, 11.0, 4.4),),
        headline=f"a cycle of {checks[3].shown}",
    )


def printed_theorem(quick: bool) -> Entry:
    """Theorem 2.4, on which figures 2.8 to 2.12 rest."""
    lams = ("1/1000", 1) if quick else ("1/1000", "1/10", 1, 1000)
    asked = [
        (m, z, growth) for m in (chua.stabilisation(), chua.synchronisation()) for z in range(4) for growth in lams
    ]
    refuted = sum(refute_printed(m, growth=growth, z=z).verdict is Verdict.INFEASIBLE for m, z, growth in asked)
    rates = chua_formulas.stabilisation().rates(relative=1e-4 if quick else 1e-6)
    checks = (
        exactly("cases of λ and z with a proof that nothing solves it", refuted, len(asked), "gains printed"),
        Check("φ4, enclosed over the whole box", float(rates.high[3]), 3.2227, 3.2231, "3.1862", "1/s"),
        close("φ1, enclosed", float(rates.high[0]), 30.15, 1e-3, "30.15", "1/s"),
        close("φ3, enclosed", float(rates.high[2]), 120.6, 1e-3, "120.6", "1/s"),
    )
    return Entry(
        "Theorem 2.4",
        "no solution for Chua's oscillator",
        Label.DIFFERS,
        "The gains of Figs 2.8 to 2.12 are said to follow from it. Whatever λ, ε and z, one diagonal entry of (2.3.6) "
        "stays positive; every case carries exact multipliers that prove it. φ4 is the maximum over the box, the "
        "printed one is a local maximum. What the printed gains do is proven below without theorem 2.4.",
        checks,
        errata=("2.3.6", "2.4.2"),
        headline=f"{refuted} of {len(asked)} cases refuted",
    )


def _settle(error: Array, step: float) -> float:
    above = np.flatnonzero(error > 0.01)
    return (float(above[-1]) + 1.0) * step if above.size else 0.0


def _last_at_limit(current: Array, step: float) -> float:
    at_limit = np.flatnonzero(np.abs(current) >= LIMIT_A * (1.0 - 1e-9))
    return (float(at_limit[-1]) + 1.0) * step if at_limit.size else 0.0


def _gains(printed: Any) -> Array:
    return to_float(exact_array(printed))


def _decay(model: Any, printed: Any) -> float:
    decay, result = largest_decay(CommonLyapunov(), model.closed_loop(printed), relative=1e-4)
    return decay if result.verdict is Verdict.PROVEN else 0.0


def stabilisation(quick: bool) -> Entry:
    """Figures 2.8 and 2.9."""
    step, model = _step(quick), chua.stabilisation()
    states = _open_loop(step)[:, 0]
    cycle = states[round(SWITCH_S / step) :]
    hull = 1.005 * cycle[np.linspace(0, len(cycle) - 1, 41, dtype=int)]
    request = Request(decay=0.3, input_limit=LIMIT_A, box={1: chua.BOX}, start=hull, objective="large set")
    design = design_quadratic(model, request)
    laws = [
        chua.stabilising_current(K, LIMIT_A) for K in (_gains(chua.PRINTED_STABILISATION_GAINS), np.asarray(design.K))
    ]
    start = np.repeat(states[round(SWITCH_S / step)][None], 2, axis=0)

    def currents(x: Array) -> Array:
        return np.array([law(one) for law, one in zip(laws, x, strict=True)])

    runs = runge_kutta(lambda _, x: chua.derivative(x, currents(x)), start, SWITCH_S, STOP_S, step)
    inputs = np.stack([np.asarray(law(runs[:, k])) for k, law in enumerate(laws)], axis=1)
    settle = [_settle(np.linalg.norm(runs[:, k], axis=-1), step) for k in range(2)]
    checks = (
        close("printed gains, |x| < 0.01 after", settle[0], 9.28, 0.01, unit="s"),
        close("printed gains, largest |u|", float(np.abs(inputs[:, 0]).max()), LIMIT_A, 1e-9, "10", "A"),
        close("printed gains, proven decay without limit", _decay(model, chua.PRINTED_STABILISATION_GAINS),
              0.3763, 2e-3, unit="1/s"),
        holds("design S proven, |u| < 10 A included", design.result.verdict is Verdict.PROVEN),
        Check("design S, |x| < 0.01 after", settle[1], 0.0, 3.8, unit="s"),
        Check("design S, largest |u|", float(np.abs(inputs[:, 1]).max()), 0.0, 9.9, unit="A"),
    )  # fmt: skip
    whole = (states[: round(SWITCH_S / step)], runs)
    return Entry(
        "Figs 2.8, 2.9",
        "Chua's oscillator brought to rest by a source of at most 10 A",
        Label.CORRECTED,
        "The printed gains work in simulation, at their limit for a second, of which no theorem of the thesis knows. "
        "Design S is proven to stay below the limit from anywhere in a set around the limit cycle, with gains fifteen "
        "times smaller, and is twice as fast.",
        checks,
        (
            Drawing(
                "Input and states; the controller acts from 20 s on",
                "Printed gains orange, design S blue.",
                lambda drawn: _draw_loop(drawn, step, whole, inputs, STATES),
                11.0,
                5.4,
            ),
        ),
        ("2.3.6", "2.4.2-limit"),
        headline=f"rest after {settle[0]:.1f} s printed, {settle[1]:.1f} s proven",
    )


def synchronisation(quick: bool) -> Entry:
    """Figures 2.10 to 2.12."""
    step, model = _step(quick), chua.synchronisation()
    both = _open_loop(step)
    design = design_quadratic(model, Request())
    laws = [
        chua.synchronising_current(K, LIMIT_A)
        for K in (_gains(chua.PRINTED_SYNCHRONISATION_GAINS), np.asarray(design.K))
    ]
    start = np.repeat(both[round(SWITCH_S / step)].reshape(1, 6), 2, axis=0)

    def motion(_: float, x: Array) -> Array:
        current = np.array([law(one) for law, one in zip(laws, x, strict=True)])
        return np.concatenate([chua.derivative(x[:, :3]), chua.derivative(x[:, 3:], current)], axis=1)

    runs = runge_kutta(motion, start, SWITCH_S, STOP_S, step)
    error = runs[..., 3:] - runs[..., :3]
    inputs = np.stack([np.asarray(law(runs[:, k])) for k, law in enumerate(laws)], axis=1)
    settle = [_settle(np.linalg.norm(error[:, k], axis=-1), step) for k in range(2)]
    checks = (
        close("printed gains, |e| < 0.01 after", settle[0], 7.38, 0.01, unit="s"),
        close("printed gains, proven decay without limit", _decay(model, chua.PRINTED_SYNCHRONISATION_GAINS),
              0.1536, 2e-3, unit="1/s"),
        holds("design Q proven", design.result.verdict is Verdict.PROVEN),
        Check("design Q, |e| < 0.01 after", settle[1], 0.0, 3.1, unit="s"),
        Check("design Q, last at the limit after", _last_at_limit(inputs[:, 1], step), 0.0, 0.1, unit="s"),
    )  # fmt: skip
    before = both[: round(SWITCH_S / step)]
    whole = (before[:, 1] - before[:, 0], error)
    leader = np.concatenate([before[:, 0], runs[:, 0, :3]])
    followers = (before[:, 1], runs[..., 3:])

    def draw_states(drawn: Any) -> None:
        axes = drawn.subplots(1, 3)
        for k, ax in enumerate(axes):
            start_s = 17.0
            times = np.arange(len(leader)) * step
            shown = (times >= start_s) & (times <= 26.0)
            ax.plot(times[shown], leader[shown, k], color="#1f2933", lw=1.2, label="leader")
            for which, colour, name in ((0, RED, "follower, printed"), (1, BLUE, "follower, design Q")):
                follower = np.concatenate([followers[0][:, k], followers[1][:, which, k]])
                ax.plot(times[shown], follower[shown], color=colour, lw=1.1, ls="--", label=name)
            ax.axvline(SWITCH_S, color=GREY, lw=0.8)
            ax.set(title=STATES[k], xlabel="t (s)")
        drawn.legend(*axes[0].get_legend_handles_labels(), loc="outside upper left", ncols=3)

    return Entry(
        "Figs 2.10–2.12",
        "A second oscillator follows the first",
        Label.CORRECTED,
        "The printed K(x) drops terms that are linear in the voltages; the weights are used here as they are. Design Q "
        "is proven without the limit of the source, which it touches only for the first moment.",
        checks,
        (
            Drawing("Fig 2.10: leader and follower", "Printed gains orange, design Q blue.", draw_states, 11.0, 3.2),
            Drawing(
                "Figs 2.11, 2.12: input and errors",
                "Printed gains orange, design Q blue.",
                lambda drawn: _draw_loop(drawn, step, whole, inputs, ("e1 (V)", "e2 (V)", "e3 (A)")),
                11.0,
                5.4,
            ),
        ),
        ("2.4.2-sync", "2.3.6"),
        headline=f"together after {settle[0]:.1f} s printed, {settle[1]:.1f} s proven",
    )


def _draw_loop(drawn: Any, step: float, whole: tuple[Array, Array], inputs: Array, names: Sequence[str]) -> None:
    before, runs = whole
    first = round(15.0 / step)
    axes = drawn.subplots(4, 1, sharex=True)
    times = SWITCH_S + np.arange(len(runs)) * step
    early = np.arange(first, len(before)) * step
    for which, colour in ((0, RED), (1, BLUE)):
        axes[0].plot(times, inputs[:, which], color=colour, lw=1.2)
    for bound in (-LIMIT_A, LIMIT_A):
        axes[0].axhline(bound, color=GREY, lw=0.8, ls=":")
    axes[0].set_ylabel("u (A)")
    for k, ax in enumerate(axes[1:]):
        ax.plot(early, before[first:, k], color=GREY, lw=1)
        for which, colour in ((0, RED), (1, BLUE)):
            ax.plot(times, runs[:, which, k], color=colour, lw=1.2)
        ax.set_ylabel(names[k])
    for ax in axes:
        ax.axvline(SWITCH_S, color=GREY, lw=0.8)
    axes[-1].set(xlabel="t (s)", xlim=(15.0, STOP_S))
