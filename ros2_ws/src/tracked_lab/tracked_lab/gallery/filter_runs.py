"""The filters that are compared on the tunnel diode circuit, and runs of it with all of them."""

from functools import lru_cache
from typing import Any

import numpy as np

from robust_core.filtering import Filter, FilterDesign, design_filter, h_infinity
from robust_core.plants import tunnel_diode
from robust_core.theorems.regions import disc
from tracked_lab.gallery.entry import Drawing
from tracked_lab.gallery.integrate import Array, runge_kutta

CENTER, RADIUS = -20.0, 19.9
REGION = disc(CENTER, RADIUS)
AMPLITUDE, STOP_S, HOLD_S, SEED = 0.5, 6.0, 0.1, 35
BLUE, RED, GREEN, GREY, INK = "#0072b2", "#d55e00", "#009e73", "#9aa5b1", "#1f2933"
FILTERS = ("printed", "optimal, printed vertices", "optimal, true vertices")
COLOURS = (RED, GREEN, BLUE)


def printed_filter() -> Filter:
    """The filter that the thesis prints."""
    parts = tunnel_diode.PRINTED_FILTER
    return Filter.of(parts["A"], parts["B"], parts["C"])


@lru_cache(maxsize=4)
def optimal_filter(attained: bool) -> FilterDesign:
    """The best H-infinity filter for the attained or for the printed vertices."""
    plant = tunnel_diode.tunnel_diode()
    return design_filter(plant.attained() if attained else plant, h_infinity(), region=REGION)


def all_filters() -> list[Filter]:
    """In the order of FILTERS."""
    return [printed_filter(), optimal_filter(False).filtering, optimal_filter(True).filtering]


class Run:
    """A simulation: times (N,), z (N,), estimates (N, 3), resistance (N,), disturbance (N,), voltage (N,)."""

    def __init__(self, times: Array, states: Array, estimates: Array, resistance: Array, disturbance: Array) -> None:
        self.times, self.signal, self.voltage = times, states[:, 1], states[:, 0]
        self.estimates, self.resistance, self.disturbance = estimates, resistance, disturbance
        self.error = self.signal[:, None] - estimates
        self.late = times >= 4.0

    def late_error(self, which: int) -> float:
        """Largest error of one filter from 4 s on."""
        return float(np.abs(self.error[self.late, which]).max())

    @property
    def late_signal(self) -> float:
        """Largest signal from 4 s on."""
        return float(np.abs(self.signal[self.late]).max())


def simulate(radians_per_s: float, step: float) -> Run:
    """The nonlinear circuit under a sine, its resistance drawn anew every HOLD_S, with all filters beside it."""
    drawn = np.random.default_rng(SEED).uniform(*tunnel_diode.RESISTANCE_OHM, round(STOP_S / HOLD_S) + 1)
    A, B, C = (np.array([f.matrices()[k] for f in all_filters()]) for k in range(3))

    def motion(t: float, x: Array) -> Array:
        w = AMPLITUDE * np.sin(radians_per_s * t)
        plant = tunnel_diode.derivative(x[0], w, drawn[int(t / HOLD_S + 1e-9)])
        return np.vstack([plant, np.einsum("fij,fj->fi", A, x[1:]) + B[:, :, 0] * (x[0, 0] - w)])

    start = np.zeros((4, 2))
    start[0] = [0.2, -0.05]
    states = runge_kutta(motion, start, 0.0, STOP_S, step)
    times: Array = np.arange(len(states)) * np.float64(step)
    estimates = np.einsum("fj,kfj->kf", C[:, 0], states[:, 1:])
    held = drawn[np.minimum((times / HOLD_S + 1e-9).astype(int), len(drawn) - 1)]
    return Run(times, states[:, 0], estimates, held, AMPLITUDE * np.sin(radians_per_s * times))


def drawings(run: Run, inputs: str, outputs: str, shown_s: float) -> tuple[Drawing, ...]:
    """Inputs and outputs of a run; ``shown_s`` of the disturbance are shown."""

    def draw_inputs(drawn: Any) -> None:
        left, right = drawn.subplots(1, 2)
        left.step(run.times, run.resistance, color=INK, lw=1, where="post")
        left.set(xlabel="t (s)", ylabel="resistance (Ω)")
        some = run.times <= shown_s
        right.plot(run.times[some], run.disturbance[some], color=INK, lw=1)
        right.set(xlabel="t (s)", ylabel="w (V)", title="" if shown_s >= STOP_S else f"first {shown_s:g} s")

    def draw_outputs(drawn: Any) -> None:
        left, right = drawn.subplots(1, 2)
        some = run.times <= max(4.0 * shown_s, 0.8)
        left.plot(run.times[some], run.signal[some], color=INK, lw=1.3, label="z")
        for k, name in enumerate(FILTERS):
            left.plot(run.times[some], run.estimates[some, k], color=COLOURS[k], lw=1, ls="--", label=f"z_f, {name}")
            right.semilogy(run.times, _envelope(run.error[:, k], run.times), color=COLOURS[k], lw=1.3)
        left.set(xlabel="t (s)", ylabel="z, z_f (A)")
        drawn.legend(*left.get_legend_handles_labels(), loc="outside upper left", ncols=4)
        right.set(xlabel="t (s)", ylabel="|z - z_f| (A), largest in 0.1 s", ylim=(1e-4, 0.1))

    note = "Printed filter orange; optimal for the printed vertices green, for the true ones blue."
    return (Drawing(inputs, "", draw_inputs, 11.0, 2.4), Drawing(outputs, note, draw_outputs, 11.0, 3.6))


def _envelope(error: Array, times: Array) -> Array:
    """Largest |error| in the tenth of a second around each time."""
    width = max(1, round(0.05 / float(times[1] - times[0])))
    padded = np.pad(np.abs(error), width, mode="edge")
    return np.asarray(np.lib.stride_tricks.sliding_window_view(padded, 2 * width + 1).max(axis=-1))
