"""Track drives: set-point, PID and motor of each belt."""

import math

from sim_bridge.belts.parameters import BeltParameters
from sim_bridge.belts.state import BeltState
from sim_bridge.compiled import compiled

# Belt speed over which the rolling resistance builds up (m/s): it must not make a belt tremble at rest.
_ROLLING_SPEED = 0.01


@compiled
def drive_belt(
    p: BeltParameters,
    state: BeltState,
    side: int,
    target: float,
    thrust: float,
    ground_damping: float,
    load: float,
    dt: float,
) -> None:
    """Advance one belt by ``dt`` towards a target speed (m/s).

    The target is limited in rate and passed through the response that controllers count on; a PID, helped by the force
    that the set-point's acceleration needs on firm ground, with a force limit and the motor's lag then moves the belt.
    The ground holds it back by ``thrust`` (N), rolling resistance by a share of the ``load`` (N) on the belt;
    ``ground_damping`` (N s/m) makes the step linearly implicit.
    """
    reach = p.drive_acceleration * dt
    target = min(max(target, -p.drive_speed), p.drive_speed)
    state.profile[side] += min(max(target - state.profile[side], -reach), reach)
    wanted = (state.profile[side] - state.setpoint[side]) * (1.0 - math.exp(-dt / p.drive_response)) / dt
    state.setpoint[side] += wanted * dt

    error = state.setpoint[side] - state.belt_speed[side]
    asked = (
        p.driven_mass * wanted
        + p.drive_proportional * error
        + state.integral[side]
        + p.drive_derivative * (error - state.error[side]) / dt
    )
    state.error[side] = error
    force = min(max(asked, -p.motor_force), p.motor_force)
    # The integral stands still while the motor is at its limit and the error would push it further.
    if asked == force or error * asked < 0.0:
        state.integral[side] += p.drive_integral * error * dt
    state.motor_force[side] += (force - state.motor_force[side]) * (1.0 - math.exp(-dt / p.motor_lag))

    rolling = p.rolling_resistance * load
    slope = rolling / _ROLLING_SPEED / math.cosh(min(abs(state.belt_speed[side]) / _ROLLING_SPEED, 20.0)) ** 2
    resisting = thrust + rolling * math.tanh(state.belt_speed[side] / _ROLLING_SPEED)
    change = (state.motor_force[side] - resisting) * dt / (p.belt_mass + (ground_damping + slope) * dt)
    state.belt_speed[side] += change
    state.belt_travel[side] += state.belt_speed[side] * dt
