"""The terminal weight of the upper layer for the design benchmark: design, loading, descent on the unicycle itself."""

import time
from dataclasses import asdict
from typing import Any

import numpy as np

from nmpc_layers import UpperSettings, load_weights
from nmpc_layers.certified_terminal import command_limits
from nmpc_layers.design_terminal import design as design_upper_terminal
from nmpc_layers.drive_limits import DriveLimits
from robust_core.analysis import Result
from robust_core.plants.tracking_error import TrackingError
from robust_core.terminal import CommandLimits, TerminalDesign
from tracked_description import load_robot
from tracked_types import PLAN_RATE_HZ


def upper_terminal_figures(steps: int, seed: int) -> tuple[dict[str, float], Result]:
    """Figures of weight and set as designed anew, of the descent from 1000 starts, and the design's result."""
    robot, entry = load_robot(), load_weights().of("improved")
    source = entry.upper_terminal
    assert source is not None
    begun = time.thread_time()
    design = design_upper_terminal(robot, "improved", entry, source, PLAN_RATE_HZ)
    values = {"terminal.design_s": time.thread_time() - begun}
    begun = time.thread_time()
    loaded = UpperSettings.from_robot(robot).certified
    values["terminal.loaded_s"] = time.thread_time() - begun
    values["terminal.loaded"] = float(loaded is not None)
    half = np.sqrt(design.level * np.diag(np.linalg.inv(design.P)))
    values |= {"terminal.half_width_m": float(half[:2].min()), "terminal.half_width_rad": float(half[2])}
    values |= {"terminal.weight_position": float(design.P[:2, :2].trace() / 2.0), "terminal.level": design.level}
    model, limits = source.tracking_error(1.0 / PLAN_RATE_HZ, 0.5), command_limits(DriveLimits.from_robot(robot))
    descent = terminal_descent(design, model, limits, asdict(entry.upper), starts=1000, steps=steps, seed=seed)
    return values | {f"terminal.{name}": value for name, value in descent.items()}, design.result


def terminal_descent(
    design: TerminalDesign,
    model: TrackingError,
    limits: CommandLimits,
    weights: Any,
    *,
    starts: int,
    steps: int,
    seed: int,
) -> dict[str, float]:
    """The terminal law on the unicycle from random starts in the set, beside references that change at random.

    descended: share of steps with V+ - V <= -(stage cost); inside: share of states in the set; limits: share within the
    commands' room; worst: the largest (V+ - V + stage) / V, negative where all descend.
    """
    rng = np.random.default_rng(seed)
    direction = rng.normal(size=(starts, 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    radius = rng.uniform(0.0, 1.0, (starts, 1)) ** (1.0 / 3.0) * np.sqrt(design.level)
    error = np.linalg.solve(np.linalg.cholesky(design.P).T, (direction * radius).T).T
    room, Q = np.array(limits.room(model)[:2]), np.array([weights["position"]] * 2 + [weights["heading"]])
    R = np.array([weights["speed"], weights["yaw_rate"]])
    good, inside, kept, worst, simple = 0, 0, 0, -np.inf, 0
    for _ in range(steps):
        change = error @ design.K.T
        speed = rng.uniform(*model.speed_mps, starts)
        yaw_rate = rng.uniform(-model.yaw_rate_radps, model.yaw_rate_radps, starts)
        after = model.step(error, change, speed, yaw_rate)
        value, following = (np.einsum("ki,ij,kj->k", e, design.P, e) for e in (error, after))
        gap = following - value + error**2 @ Q + change**2 @ R
        good += int((gap <= 0.0).sum())
        simple += int((following - value <= -Q.min() * (error**2).sum(axis=1)).sum())
        inside += int(np.sum(design.contains(after)))
        kept += int((np.abs(change) <= room).all(axis=1).sum())
        worst = max(worst, float((gap / value).max()))
        error = after
    total = float(starts * steps)
    return {
        "descended": good / total,
        "inequality_5_2_21": simple / total,
        "inside": inside / total,
        "limits_kept": kept / total,
        "worst_excess": worst,
    }
