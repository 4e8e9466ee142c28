"""Discrete motion of the base as CasADi expressions: what both layers predict with."""

import math
from dataclasses import dataclass
from enum import Enum
from typing import Any

import casadi
import numpy as np
from numpy.typing import NDArray

Expression = Any  # casadi ships no types


class Motion(Enum):
    """Structure of the prediction model; its numbers are run-time inputs (`MotionParameters`)."""

    KINEMATIC = "kinematic"  # pose only, the belts obey at once: (5.2.1) and (5.2.11)
    LAG = "lag"  # pose and belt twist, which follows the command with a first-order lag

    @property
    def state_count(self) -> int:
        """3 (x, y, yaw), or 5 with the belts' speed and yaw rate."""
        return 3 if self is Motion.KINEMATIC else 5


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionParameters:
    """Numbers of the prediction model.

    period_s: length of one step. heading_point: where in the step its heading is taken, 0 as printed in
    (5.2.1), 0.5 for the midpoint rule (erratum 5.2.4). speed_slip_mps, yaw_slip_radps: additive slip g of
    (5.2.11), frozen over the horizon (erratum 5.2.6). yaw_efficiency: ground yaw rate per belt yaw rate
    that the model expects, slip being what remains. lag_s: time constant of the belts (Motion.LAG only). slide_s: angle
    by which the base moves outwards off its heading, per yaw rate.
    """

    period_s: float
    heading_point: float = 0.5
    speed_slip_mps: float = 0.0
    yaw_slip_radps: float = 0.0
    yaw_efficiency: float = 1.0
    lag_s: float = 0.06
    slide_s: float = 0.0

    def as_array(self) -> NDArray[np.float64]:
        """The model's parameter vector, shape (8,).

        The exponential of the lag is taken here, once per problem, and not in every stage.
        """
        decay = math.exp(-self.period_s / self.lag_s)
        mean = self.lag_s / self.period_s * (1.0 - decay)
        return np.array(
            [
                self.period_s,
                self.heading_point,
                self.speed_slip_mps,
                self.yaw_slip_radps,
                self.yaw_efficiency,
                decay,
                mean,
                self.slide_s,
            ]
        )


PARAMETER_COUNT = 8


def next_state(motion: Motion, state: Expression, command: Expression, parameters: Expression) -> Expression:
    """State one step later: x+ = x + f(x, u) + g(x, u) (erratum 5.2.6).

    state: (3,) or (5,), see `Motion`; command: (2,) speed and yaw rate asked of the belts;
    parameters: (8,) as `MotionParameters.as_array`. The lag is the exact response to a constant command:
    the pose moves with the belts' mean over the step.
    """
    period, heading_point, speed_slip, yaw_slip, yaw_efficiency, decay, mean, slide = casadi.vertsplit(parameters)
    belts = command if motion is Motion.KINEMATIC else command + mean * (state[3:5] - command)
    speed = belts[0] + speed_slip
    yaw_rate = yaw_efficiency * belts[1] + yaw_slip
    heading = state[2] + heading_point * period * yaw_rate - slide * yaw_rate
    pose = state[:3] + period * casadi.vertcat(speed * casadi.cos(heading), speed * casadi.sin(heading), yaw_rate)
    if motion is Motion.KINEMATIC:
        return pose
    return casadi.vertcat(pose, command + decay * (state[3:5] - command))
