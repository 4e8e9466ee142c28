"""Legs: motions from rest to rest, laid end to end into a trajectory."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tracked_navigation.rest_to_rest import RestToRest
from tracked_types import Pose2, Trajectory, wrap_angle

Array = NDArray[np.float64]
_NODES, _WEIGHTS = (np.asarray(values, dtype=np.float64) for values in np.polynomial.legendre.leggauss(5))


@dataclass(frozen=True, slots=True)
class DriveLeg:
    """Drive ``law.distance`` metres; heading and curvature are functions of the distance covered (m).

    heading: rad, 0 at the start of the leg. curvature: its derivative, 1/m.
    """

    law: RestToRest
    heading: Callable[[Array], Array]
    curvature: Callable[[Array], Array]


@dataclass(frozen=True, slots=True)
class TurnLeg:
    """Turn on the spot by ``law.distance`` rad; ``sign`` +1 is to the left."""

    law: RestToRest
    sign: int


Leg = DriveLeg | TurnLeg


def lay(legs: Sequence[Leg], step_s: float, frame_id: str = "") -> Trajectory:
    """Trajectory of ``legs`` from the origin, sampled every ``step_s`` (the step of the legs' time laws).

    Positions are the integral of the unicycle over the continuous inputs (Gauss-Legendre, five points in
    every step: error below 1e-9 m), so states and inputs agree to rounding.

    Raises
    ------
    ValueError: if the legs contain no motion.
    """
    pose = Pose2(0.0, 0.0, 0.0)
    states, inputs = [pose.as_array()[None]], [np.zeros((1, 2))]
    for leg in legs:
        leg_states, leg_inputs = _sample(leg, step_s)
        states.append(_placed(leg_states[1:], pose))
        inputs.append(leg_inputs[1:])
        pose = Pose2(*(float(value) for value in states[-1][-1])) if leg.law.steps else pose
    all_states = np.concatenate(states)
    if len(all_states) < 2:
        raise ValueError("the shape contains no motion")
    return Trajectory(0, frame_id, sample_times(len(all_states), step_s), all_states, np.concatenate(inputs))


def sample_times(count: int, step_s: float) -> Array:
    """``count`` times from 0 in steps of ``step_s``, shape (count,)."""
    return np.arange(count, dtype=np.float64) * step_s


def _sample(leg: Leg, step_s: float) -> tuple[Array, Array]:
    times = sample_times(leg.law.steps + 1, step_s)
    covered, rate = leg.law.at(times)
    zeros = np.zeros_like(covered)
    if isinstance(leg, TurnLeg):
        return np.stack((zeros, zeros, leg.sign * covered), 1), np.stack((zeros, leg.sign * rate), 1)
    inner = times[:-1, None] + 0.5 * step_s * (1.0 + _NODES)  # (steps, 5)
    inner_covered, inner_rate = leg.law.at(inner)
    inner_heading = leg.heading(inner_covered)
    weights = 0.5 * step_s * _WEIGHTS
    x = np.concatenate(([0.0], np.cumsum((inner_rate * np.cos(inner_heading)) @ weights)))
    y = np.concatenate(([0.0], np.cumsum((inner_rate * np.sin(inner_heading)) @ weights)))
    return np.stack((x, y, leg.heading(covered)), 1), np.stack((rate, rate * leg.curvature(covered)), 1)


def _placed(states: Array, origin: Pose2) -> Array:
    """``states`` (n, 3), given in the frame of ``origin``, in the parent frame of ``origin``."""
    cosine, sine = np.cos(origin.yaw_rad), np.sin(origin.yaw_rad)
    x, y, yaw = states.T
    return np.stack(
        (
            origin.x_m + cosine * x - sine * y,
            origin.y_m + sine * x + cosine * y,
            wrap_angle(origin.yaw_rad + yaw),
        ),
        1,
    )


def placed(trajectory: Trajectory, origin: Pose2, stamp_ns: int, frame_id: str) -> Trajectory:
    """``trajectory``, given in the frame of ``origin``, in ``frame_id`` and counted from ``stamp_ns``."""
    states = _placed(trajectory.states, origin)
    return Trajectory(stamp_ns, frame_id, trajectory.times_s, states, trajectory.inputs)
