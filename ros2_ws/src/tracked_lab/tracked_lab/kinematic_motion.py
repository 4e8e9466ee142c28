"""Motion of the kinematic plant over one tick of its IMU, compiled."""

import math
from typing import Any

import numpy as np

from sim_bridge.compiled import compiled

SUBSTEPS = 4
TERRAIN_CORRELATION_S = 0.5
TIGHT_CURVATURE = 2.5
LEAST_SPEED_MPS = 0.05
LEAST_RATIO = 0.7
OVERRIDDEN = 0.7
FULLY_MOVING_MPS = 0.1

# Rows of the state.
X, Y, YAW, LEFT, RIGHT, LEFT_TRAVEL, RIGHT_TRAVEL = range(7)
SPEED, SIDEWAYS, YAW_RATE, FORWARD, TURN, YAW_TERRAIN, SPEED_TERRAIN = range(7, 14)
STATES = 14


@compiled
def move(
    state: Any,
    ground: Any,
    targets: Any,
    acceleration_limit_mps2: float,
    gauge_m: float,
    time_s: float,
    step_s: float,
    yaw_noise: float,
    speed_noise: float,
) -> Any:
    """Advance ``state`` (STATES,) in place by SUBSTEPS steps; the mean yaw rate of the tick (rad/s).

    ``ground`` as `Ground.as_array`; ``targets`` (SUBSTEPS, 2): speeds asked of the left and right belt; ``time_s`` at
    the beginning; the noises are standard normal. FORWARD and TURN add up the way ahead and the turn.
    """
    lag_s, loss, on_spot, yaw_terrain, speed_loss, in_turns, speed_terrain, skid_m = ground[:8]
    kick_radps, kick_loss, begin_s, end_s = ground[8:]
    decay = math.exp(-SUBSTEPS * step_s / TERRAIN_CORRELATION_S)
    fresh = math.sqrt(1.0 - decay * decay)
    state[YAW_TERRAIN] = decay * state[YAW_TERRAIN] + fresh * yaw_terrain * yaw_noise
    state[SPEED_TERRAIN] = decay * state[SPEED_TERRAIN] + fresh * speed_terrain * speed_noise
    gain = 1.0 - math.exp(-step_s / lag_s)
    largest = acceleration_limit_mps2 * step_s
    before = state[YAW]
    for substep in range(SUBSTEPS):
        for side in range(2):
            change = gain * (targets[substep, side] - state[LEFT + side])
            state[LEFT + side] += min(max(change, -largest), largest)
            state[LEFT_TRAVEL + side] += step_s * state[LEFT + side]
        speed = 0.5 * (state[LEFT] + state[RIGHT])
        yaw_rate = (state[RIGHT] - state[LEFT]) / gauge_m
        curvature = abs(yaw_rate) / max(abs(speed), LEAST_SPEED_MPS)
        ratio = 1.0 + loss + on_spot * (1.0 - math.exp(-curvature / TIGHT_CURVATURE)) + state[YAW_TERRAIN]
        speed *= 1.0 - speed_loss - in_turns * abs(yaw_rate) - state[SPEED_TERRAIN]
        yaw_rate /= max(ratio, LEAST_RATIO)
        now_s = time_s + substep * step_s
        if kick_radps != 0.0 and begin_s < now_s < end_s:
            share = math.sin(math.pi * (now_s - begin_s) / (end_s - begin_s)) * min(abs(speed) / FULLY_MOVING_MPS, 1.0)
            yaw_rate = (1.0 - OVERRIDDEN * share) * yaw_rate + kick_radps * share
            speed *= 1.0 - kick_loss * share
        sideways = -skid_m * yaw_rate
        middle = state[YAW] + 0.5 * step_s * yaw_rate
        state[X] += step_s * (speed * math.cos(middle) - sideways * math.sin(middle))
        state[Y] += step_s * (speed * math.sin(middle) + sideways * math.cos(middle))
        state[YAW] += step_s * yaw_rate
        state[FORWARD] += step_s * speed
        state[SPEED], state[SIDEWAYS], state[YAW_RATE] = speed, sideways, yaw_rate
    turn = state[YAW] - before
    state[TURN] += turn
    return turn / (SUBSTEPS * step_s)


@compiled
def sense(
    state: Any,
    speed_before: float,
    sideways_before: float,
    mean_yaw_rate: float,
    period_s: float,
    mount: Any,
    gravity_mps2: float,
    rates: Any,
    forces: Any,
) -> None:
    """Add to the noise of one IMU sample, ``rates`` and ``forces`` (3,), what the IMU measures.

    ``mount`` (3, 3): its columns are the sensor's axes in the base. Where it sits is left out of account.
    """
    ahead = (state[SPEED] - speed_before) / period_s - mean_yaw_rate * state[SIDEWAYS]
    left = (state[SIDEWAYS] - sideways_before) / period_s + mean_yaw_rate * state[SPEED]
    for axis in range(3):
        rates[axis] += mount[2, axis] * mean_yaw_rate
        forces[axis] += mount[0, axis] * ahead + mount[1, axis] * left + mount[2, axis] * gravity_mps2


def new_state(x_m: float, y_m: float, yaw_rad: float) -> Any:
    """State (STATES,) at rest at a pose."""
    state = np.zeros(STATES)
    state[X], state[Y], state[YAW] = x_m, y_m, yaw_rad
    return state
