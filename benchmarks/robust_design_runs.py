"""Simulations for the design benchmark: Chua's oscillators, the tunnel diode with filters, the tracking error."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robust_core.filtering import Filter
from robust_core.plants import chua, tunnel_diode
from tracked_lab.gallery.integrate import runge_kutta

Array = NDArray[np.float64]
SWITCH_S = 20.0
START = (-0.1, -0.1, 0.1)
FOLLOWER_START = (0.1, 0.1, -0.1)
LIMIT_A = 10.0
PERIOD_S = 1.8015  # of the limit cycle


@dataclass(frozen=True, slots=True)
class ChuaRun:
    """settle_s: until the error stays below 0.01; peak_a: largest |u|; last_limit_s: when it was last at the limit."""

    settle_s: float
    peak_a: float
    last_limit_s: float


def open_loop(step: float) -> Array:
    """States of leader and follower until the switch and for one period after it, (count, 2, 3)."""
    start = np.array([START, FOLLOWER_START])
    return runge_kutta(lambda _, x: chua.derivative(x), start, 0.0, SWITCH_S + PERIOD_S, step)


def limit_cycle(states: Array, step: float, points: int = 41) -> Array:
    """Points around one period of the cycle, moved out by half a percent so that their hull holds the arcs between."""
    cycle = states[round(SWITCH_S / step) :, 0]
    return np.asarray(1.005 * cycle[np.linspace(0, len(cycle) - 1, points, dtype=int)])


def stabilise(gains: Sequence[Array], states: Array, duration: float, step: float) -> list[ChuaRun]:
    """Every set of gains from the switch on, with the source's limit."""
    laws = [chua.stabilising_current(K, LIMIT_A) for K in gains]
    start = np.repeat(states[round(SWITCH_S / step), 0][None], len(gains), axis=0)

    def currents(x: Array) -> Array:
        return np.array([law(one) for law, one in zip(laws, x, strict=True)])

    found = runge_kutta(lambda _, x: chua.derivative(x, currents(x)), start, 0.0, duration, step)
    return [
        _judge(np.linalg.norm(found[:, k], axis=-1), np.asarray(law(found[:, k])), step) for k, law in enumerate(laws)
    ]


def synchronise(gains: Sequence[Array], states: Array, duration: float, step: float) -> list[ChuaRun]:
    """The follower under every set of gains from the switch on, with the source's limit."""
    laws = [chua.synchronising_current(K, LIMIT_A) for K in gains]
    both = states[round(SWITCH_S / step)].ravel()
    start = np.repeat(both[None], len(gains), axis=0)

    def motion(_: float, x: Array) -> Array:
        current = np.array([law(one) for law, one in zip(laws, x, strict=True)])
        return np.concatenate([chua.derivative(x[:, :3]), chua.derivative(x[:, 3:], current)], axis=1)

    found = runge_kutta(motion, start, 0.0, duration, step)
    error = np.linalg.norm(found[..., 3:] - found[..., :3], axis=-1)
    return [_judge(error[:, k], np.asarray(law(found[:, k])), step) for k, law in enumerate(laws)]


def _judge(error: Array, current: Array, step: float) -> ChuaRun:
    above = np.flatnonzero(error > 0.01)
    settle = np.nan if above.size and above[-1] == len(error) - 1 else (above[-1] + 1 if above.size else 0) * step
    at_limit = np.flatnonzero(np.abs(current) >= LIMIT_A * (1.0 - 1e-9))
    return ChuaRun(float(settle), float(np.abs(current).max()), float(at_limit[-1] * step) if at_limit.size else 0.0)


def filter_errors(filters: Sequence[Filter], radians_per_s: float, *, seed: int, step: float = 5e-4) -> Array:
    """Largest |z - z_f| per amplitude of w = 0.5 sin(radians_per_s t) over 4 s to 6 s, of the nonlinear circuit.

    Rows: resistance 7, 10, 13 ohm frozen and five runs drawn anew every 0.1 s; columns: filters.
    """
    rng = np.random.default_rng(seed)
    duration, amplitude, hold = 6.0, 0.5, 0.1
    drawn = rng.uniform(*tunnel_diode.RESISTANCE_OHM, (round(duration / hold) + 1, 5))
    fixed = np.array([tunnel_diode.RESISTANCE_OHM[0], 10.0, tunnel_diode.RESISTANCE_OHM[1]])
    A, B, C = (np.array([f.matrices()[k] for f in filters]) for k in range(3))
    runs = len(fixed) + drawn.shape[1]

    def motion(t: float, x: Array) -> Array:
        w = amplitude * np.sin(radians_per_s * t)
        resistance = np.concatenate([fixed, drawn[int(t / hold)]])
        plant, state = x[:, 0], x[:, 1:]
        moved = np.einsum("fij,rfj->rfi", A, state) + B[:, :, 0] * (plant[:, None, :1] - w)
        return np.concatenate([tunnel_diode.derivative(plant, w, resistance)[:, None], moved], axis=1)

    start = np.zeros((runs, 1 + len(filters), 2))
    start[:, 0] = [0.2, -0.05]
    found = runge_kutta(motion, start, 0.0, duration, step)[round(4.0 / step) :]
    estimate = np.einsum("fj,krfj->krf", C[:, 0], found[:, :, 1:])
    return np.asarray(np.abs(found[:, :, 0, 1:2] - estimate).max(axis=0) / amplitude)
