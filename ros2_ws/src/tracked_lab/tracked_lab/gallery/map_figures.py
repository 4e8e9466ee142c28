"""Figures 2.1 to 2.4: maps of proven stability of example 2.4.1, and responses that prove nothing."""

import math
from typing import Any

import numpy as np

from robust_core.analysis import sweep
from robust_core.plants import example_2_4_1
from robust_core.theorems import CommonLyapunov, ParameterDependent, Relaxed, Slack, TensorCorners, TensorProduct
from robust_core.verdict import Verdict
from tracked_lab.gallery.entry import Check, Drawing, Entry, Label, exactly
from tracked_lab.gallery.integrate import Array, runge_kutta

PRINTED = (CommonLyapunov(), ParameterDependent(), Relaxed())
BEYOND = (Slack(), TensorCorners(), TensorProduct())
# Okabe and Ito's colours.
COLOUR = {"2.1": "#0072b2", "2.2": "#e69f00", "2.3": "#009e73", "slack": "#56b4e9", "T1": "#cc79a7", "T2": "#f0b8d9"}
MARKER = {"2.1": "*", "2.2": "x", "2.3": "o", "slack": "^", "T1": "s", "T2": "D"}
COUNTS = {
    # steps, box: proven by 2.1, 2.2, 2.3, slack, T1, T2
    (21, "40"): (13, 296, 330, 351, 370, 441),
    (21, "2"): (13, 0, 185, 185, 238, 363),
    (11, "40"): (5, 81, 89),
    (11, "2"): (5, 0, 51),
}
# In the thesis's words; its figures carry no numbers.
THESIS = {"40": ("fewest", "more than 2.1", "more than 2.2"), "2": ("few", "none", "more than 2.1")}


def small_box(quick: bool) -> Entry:
    """Figure 2.1: |x1|, |x2| <= pi/40."""
    return _map(
        quick,
        "40",
        "Fig 2.1",
        "Of the thesis's theorems 2.3 proves most here, and it contains the other two at every point of this grid. "
        "Forms that use which weights sum to what (T1, T2) leave no point open: they prove all of the map. The thesis "
        "names no grid; its entry (1, 2) of (2.4.1) is a misprint.",
    )


def large_box(quick: bool) -> Entry:
    """Figure 2.2: |x1|, |x2| <= pi/2."""
    return _map(
        quick,
        "2",
        "Fig 2.2",
        "The rates of the weights are too large for theorem 2.2, which is proven to say nothing at every point, as the "
        "thesis found. The bounds are taken over the whole box by interval arithmetic: at the corners alone the rates "
        "vanish, and the map would be false.",
    )


def _map(quick: bool, box: str, figure: str, text: str) -> Entry:
    steps = 11 if quick else 21
    theorems = PRINTED if quick else (*PRINTED, *BEYOND)
    points = example_2_4_1.grid(steps)
    found = sweep(theorems, example_2_4_1.Family(math.pi / float(box)), points, workers=1)
    wanted = COUNTS[steps, box]
    thesis = (*THESIS[box], *["–"] * 3)
    checks = [
        exactly(f"points proven by {_called(t.NAME)}", found.count(k, Verdict.PROVEN), wanted[k], thesis[k])
        for k, t in enumerate(theorems)
    ]
    decided = sum(found.count(k, v) for k in range(len(theorems)) for v in (Verdict.PROVEN, Verdict.INFEASIBLE))
    checks.append(exactly("verdicts without proof", len(theorems) * len(points) - decided, 0))
    proven = {t.NAME: found.verdicts[k] == Verdict.PROVEN for k, t in enumerate(theorems)}
    outside = int(((proven["2.1"] | proven["2.2"]) & ~proven["2.3"]).sum())
    checks.append(exactly("points of 2.1 or 2.2 that 2.3 lacks", outside, 0, "0"))
    return Entry(
        figure,
        f"Where example 2.4.1 is proven stable, |x1|, |x2| ≤ π/{box}",
        Label.CORRECTED,
        text,
        tuple(checks),
        (
            Drawing(
                f"{steps} × {steps} points, every verdict proven in exact arithmetic",
                "Each point has the colour of the first theorem in the legend that proves it. Left the thesis's three "
                "theorems, right with the slack form and the tensor forms T1 and T2. Grey: proven that the theorems "
                "say nothing, which is no instability.",
                lambda drawn: _draw(drawn, points, proven),
                11.0,
                5.0,
            ),
        ),
        ("2.4.1", "2.4.1-phi", "2.2.7", "2.2.11"),
        headline=", ".join(f"{c.what.rsplit(' ', 1)[1]}: {c.shown}" for c in checks[: len(theorems)]),
    )


def _called(name: str) -> str:
    return f"theorem {name}" if name[0].isdigit() else f"form {name}"


def _draw(drawn: Any, points: Array, proven: dict[str, Any]) -> None:
    parts = [list(proven)[:3]] + ([list(proven)] if len(proven) > 3 else [])
    axes = np.atleast_1d(drawn.subplots(1, len(parts), sharey=True))
    for ax, names in zip(axes, parts, strict=True):
        rest = np.ones(len(points), dtype=bool)
        for name in names:
            new = rest & proven[name]
            rest &= ~proven[name]
            line = {"linewidths": 1.4} if MARKER[name] == "x" else {"lw": 0}
            label = f"{name}: {int(proven[name].sum())}"
            size = 44 if MARKER[name] == "*" else 22
            ax.scatter(*points[new].T, s=size, marker=MARKER[name], color=COLOUR[name], label=label, **line)
        ax.scatter(*points[rest].T, s=5, color="#b8c1cb", label=f"none: {int(rest.sum())}", lw=0)
        ax.grid(False)
        ax.set(xlabel="α", xlim=(-20.7, 0.7), ylim=(97, 203))
        ax.legend(loc="lower left", bbox_to_anchor=(-0.01, 1.0), ncols=4, handletextpad=0.2, columnspacing=1.0)
    axes[0].set_ylabel("β")


def responses(quick: bool) -> Entry:
    """Figures 2.3 and 2.4, and a point where theorem 2.3 proves nothing."""
    step = 2e-3 if quick else 5e-4
    cases = {"Fig 2.3: α = -14, β = 100": (-14.0, 100.0), "Fig 2.4: α = -20, β = 200": (-20.0, 200.0)}
    cases["no proof at ±π/2: α = 0, β = 200"] = (0.0, 200.0)
    times: Array = np.arange(round(2.0 / step) + 1) * np.float64(step)
    runs = {name: _response(*case, step) for name, case in cases.items()}
    last = [float(np.abs(run[-1]).max()) for run in runs.values()]
    stable = max(_slowest(alpha, beta) for alpha, beta in example_2_4_1.grid(11))
    checks = (
        Check("Fig 2.3, largest state at 2 s", last[0], 0.0, 1e-3, "converges"),
        Check("Fig 2.4, largest state at 2 s", last[1], 0.0, 1e-3, "converges"),
        Check("third case, largest state at 2 s", last[2], 0.0, 1e-3),
        Check("largest real part of A(0) on the whole map", stable, -math.inf, -1e-9, unit="1/s"),
    )
    return Entry(
        "Figs 2.3, 2.4",
        "Responses from x(0) = (-π/200, π/200)",
        Label.REPRODUCED,
        "The responses converge as printed. They prove nothing about the theorems: the origin is locally stable at "
        "every point of the map, the points that no theorem proves included (right).",
        checks,
        (Drawing("State responses", "x1 blue, x2 orange.", lambda drawn: _draw_runs(drawn, times, runs), 11.0, 3.0),),
        ("2.4.1-figures", "2.3"),
        headline="converge, and so would every point of the map",
    )


def _matrix(x: Array, alpha: float, beta: float) -> Array:
    s = np.sin(x).sum()
    return np.array(
        [
            [-3.5 + 0.25 * s, -4.0],
            [0.5 * (beta - 1) + 0.15 * (beta + 1) * s, 0.5 * (alpha - 2) - 0.1 * (alpha + 2) * s],
        ]
    )


def _slowest(alpha: float, beta: float) -> float:
    return float(np.linalg.eigvals(_matrix(np.zeros(2), alpha, beta)).real.max())


def _response(alpha: float, beta: float, step: float) -> Array:
    start = np.array([-math.pi / 200.0, math.pi / 200.0])
    return runge_kutta(lambda _, x: _matrix(x, alpha, beta) @ x, start, 0.0, 2.0, step)


def _draw_runs(drawn: Any, times: Array, runs: dict[str, Array]) -> None:
    axes = drawn.subplots(1, len(runs), sharey=True)
    for ax, (name, run) in zip(axes, runs.items(), strict=True):
        ax.plot(times, run[:, 0], color=COLOUR["2.1"])
        ax.plot(times, run[:, 1], color=COLOUR["2.2"])
        ax.set(title=name, xlabel="t (s)")
    axes[0].set_ylabel("states")
