"""Gauss-Newton model of the cost in the commands alone, as a CasADi function of the problem."""

from typing import Any

import casadi

from nmpc_layers.solver.motion_model import PARAMETER_COUNT, Motion, next_state
from nmpc_layers.solver.terminal_weight import PACKED_COUNT, unpacked, weighed
from nmpc_layers.solver.weights import STAGE_COUNT, WEIGHT_COUNT

Expression = Any
Function = Any

INPUT_NAMES = ["start", "commands", "state_reference", "input_reference", "parameters", "weights"]
OUTPUT_NAMES = ["hessian", "gradient", "cost", "states"]


def condensed_cost(motion: Motion, horizon: int) -> Function:
    """Build the function for ``horizon`` stages.

    Inputs as in `riccati_iteration`, without bounds. Outputs: Hessian (2N, 2N, positive definite) and
    gradient (2N,) with respect to the commands, stage by stage; the cost; the states (n, N+1).
    One loop over the stages carries the sensitivity of the state to all commands and adds each stage's
    share, so the generated code stays small; the work grows with N cubed.
    """
    count = motion.state_count
    symbol = casadi.MX.sym
    start, commands = symbol("start", count), symbol("commands", 2, horizon)
    state_reference, input_reference = symbol("state_reference", 3, horizon + 1), symbol("input_reference", 2, horizon)
    parameters, weights = symbol("parameters", PARAMETER_COUNT), symbol("weights", WEIGHT_COUNT)

    stage, layout = _stage(motion, horizon)
    diagonal = casadi.vertcat(weights[0], 0, 0, weights[1], 0, weights[2])
    pose_weights = casadi.horzcat(casadi.repmat(diagonal, 1, horizon - 1), weights[STAGE_COUNT:])
    selectors = casadi.DM.eye(2 * horizon).reshape((4 * horizon, horizon))
    carried = stage.mapaccum(horizon)(
        casadi.vertcat(start, casadi.MX.zeros(layout.total - count)),
        commands,
        state_reference[:, 1:],
        pose_weights,
        casadi.repmat(parameters, 1, horizon),
        selectors,
    )
    final = carried[:, -1]
    input_error = casadi.vec(commands - input_reference)
    input_weights = casadi.repmat(weights[3:5], horizon, 1)
    first_error = start[:3] - state_reference[:, 0]
    cost = final[layout.cost] + casadi.dot(weights[:3], first_error**2) + casadi.dot(input_weights, input_error**2)
    gradient = final[layout.gradient] + 2 * input_weights * input_error
    hessian = layout.unpack_hessian(final) + casadi.diag(2 * input_weights)
    states = casadi.horzcat(start, carried[:count, :])
    return casadi.Function(
        f"condensed_{motion.value}_{horizon}",
        [start, commands, state_reference, input_reference, parameters, weights],
        [casadi.densify(hessian), gradient, cost, states],
        INPUT_NAMES,
        OUTPUT_NAMES,
    )


class _Layout:
    """Where the parts of the carried vector lie: state, cost, sensitivity, gradient, lower triangle of the Hessian."""

    def __init__(self, count: int, horizon: int) -> None:
        size = 2 * horizon
        self.size = size
        self.state = slice(0, count)
        self.cost = count
        self.sensitivity = slice(count + 1, count + 1 + count * size)
        self.gradient = slice(self.sensitivity.stop, self.sensitivity.stop + size)
        self.hessian = slice(self.gradient.stop, self.gradient.stop + size * (size + 1) // 2)
        self.total = self.hessian.stop

    def unpack_hessian(self, carried: Expression) -> Expression:
        """Full symmetric Hessian from the packed triangle (stored by columns)."""
        triangle = casadi.Sparsity.lower(self.size)
        lower = casadi.MX(triangle, carried[self.hessian])
        return casadi.tril2symm(lower)


def _stage(motion: Motion, horizon: int) -> tuple[Function, _Layout]:
    """One step of the loop: advance the state and its sensitivity, add the cost of where it arrives."""
    count = motion.state_count
    layout = _Layout(count, horizon)
    symbol = casadi.SX.sym
    carried = symbol("carried", layout.total)
    command, reference, pose_weights = (
        symbol("command", 2),
        symbol("reference", 3),
        symbol("pose_weights", PACKED_COUNT),
    )
    parameters, selector = symbol("parameters", PARAMETER_COUNT), symbol("selector", 2 * layout.size)

    state, at = symbol("state", count), symbol("at", 2)
    following = next_state(motion, state, at, parameters)
    arguments = [state, at, parameters]
    outputs = [following, casadi.jacobian(following, state), casadi.jacobian(following, at)]
    linearised = casadi.Function("linearised", arguments, outputs)
    new_state, by_state, by_command = linearised(carried[layout.state], command, parameters)

    sensitivity = casadi.reshape(carried[layout.sensitivity], count, layout.size)
    # The selector holds two columns of the identity: they place this stage's command among all commands.
    place = casadi.reshape(selector, layout.size, 2).T
    sensitivity = by_state @ sensitivity + by_command @ place
    error = new_state[:3] - reference
    of_pose = sensitivity[:3, :]
    weighted = 2 * unpacked(pose_weights) @ of_pose
    triangle = casadi.tril(of_pose.T @ weighted)
    new = casadi.vertcat(
        new_state,
        carried[layout.cost] + weighed(pose_weights, error),
        casadi.vec(sensitivity),
        carried[layout.gradient] + weighted.T @ error,
        carried[layout.hessian] + triangle.nz[:],
    )
    return casadi.Function("stage", [carried, command, reference, pose_weights, parameters, selector], [new]), layout
