"""The same optimal control problems written the ways they usually are: CasADi's Opti, and do-mpc."""

import warnings
from typing import Any

import casadi
import numpy as np
from numpy.typing import NDArray

from nmpc_layers.solver.motion_model import PARAMETER_COUNT, Motion, MotionParameters, next_state
from nmpc_layers.solver.problem import Problem
from nmpc_layers.solver.terminal_weight import PACKED_COUNT, weighed
from nmpc_layers.solver.weights import STAGE_COUNT, WEIGHT_COUNT

Array = NDArray[np.float64]


class OptiPeer:
    """IPOPT behind Opti, multiple shooting, solved anew with ``solve()`` as its tutorial does."""

    def __init__(self, motion: Motion, horizon: int) -> None:
        opti = casadi.Opti()
        count = motion.state_count
        self._states, self._commands = opti.variable(count, horizon + 1), opti.variable(2, horizon)
        self._start, self._reference = opti.parameter(count), opti.parameter(3, horizon + 1)
        self._targets, self._parameters, self._weights = (
            opti.parameter(2, horizon),
            opti.parameter(PARAMETER_COUNT),
            opti.parameter(WEIGHT_COUNT),
        )
        self._low, self._high = opti.parameter(2), opti.parameter(2)
        cost = weighed(self._weights[STAGE_COUNT:], self._states[:3, horizon] - self._reference[:, horizon])
        opti.subject_to(self._states[:, 0] == self._start)
        for stage in range(horizon):
            state, command = self._states[:, stage], self._commands[:, stage]
            opti.subject_to(self._states[:, stage + 1] == next_state(motion, state, command, self._parameters))
            cost += casadi.dot(self._weights[:3], (state[:3] - self._reference[:, stage]) ** 2)
            cost += casadi.dot(self._weights[3:5], (command - self._targets[:, stage]) ** 2)
        opti.minimize(cost)
        for row in range(2):
            opti.subject_to(opti.bounded(self._low[row], self._commands[row, :], self._high[row]))
        opti.solver("ipopt", {"print_time": 0, "ipopt.print_level": 0, "ipopt.sb": "yes"})
        self._opti, self._cost = opti, cost
        self._guess = np.zeros((horizon, 2))
        self.commands = self._guess

    def start_from(self, guess: Array) -> None:
        """Commands (N, 2) from which the next solve starts."""
        self._guess = guess

    def solve(self, problem: Problem) -> float:
        """The optimal cost."""
        opti = self._opti
        opti.set_value(self._start, problem.start)
        opti.set_value(self._reference, problem.state_reference.T)
        opti.set_value(self._targets, problem.input_reference.T)
        opti.set_value(self._parameters, problem.parameters.as_array())
        opti.set_value(self._weights, problem.weight_array())
        opti.set_value(self._low, problem.low)
        opti.set_value(self._high, problem.high)
        opti.set_initial(self._states[:3, :], problem.state_reference.T)
        opti.set_initial(self._commands, self._guess.T)
        found = opti.solve()
        self.commands = np.asarray(found.value(self._commands)).T
        return float(found.value(self._cost))


class DoMpcPeer:
    """do-mpc's controller; slip and references are time-varying parameters, weights and lag are built in."""

    def __init__(self, motion: Motion, horizon: int, sample: Problem) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            import do_mpc
        self._horizon, self._problem = horizon, sample
        self.commands = np.zeros((horizon, 2))
        model = do_mpc.model.Model("discrete")
        state = model.set_variable("_x", "state", (motion.state_count, 1))
        command = model.set_variable("_u", "command", (2, 1))
        reference, target = (
            model.set_variable("_tvp", "reference", (3, 1)),
            model.set_variable("_tvp", "target", (2, 1)),
        )
        parameters = model.set_variable("_tvp", "parameters", (PARAMETER_COUNT, 1))
        last = model.set_variable("_tvp", "last", (PACKED_COUNT, 1))
        model.set_rhs("state", next_state(motion, state, command, parameters))
        model.setup()
        weights = casadi.DM(sample.weight_array())
        controller = do_mpc.controller.MPC(model)
        controller.settings.n_horizon, controller.settings.t_step = horizon, sample.parameters.period_s
        controller.settings.store_full_solution = False
        controller.settings.supress_ipopt_output()
        error = state[:3] - reference
        stage = casadi.dot(weights[:3], error**2) + casadi.dot(weights[3:5], (command - target) ** 2)
        controller.set_objective(lterm=stage, mterm=weighed(last, error))
        controller.set_rterm(command=0.0)
        controller.bounds["lower", "_u", "command"] = sample.low
        controller.bounds["upper", "_u", "command"] = sample.high
        self._template = controller.get_tvp_template()
        controller.set_tvp_fun(self._varying)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            controller.setup()
        self._controller = controller
        controller.x0 = sample.start
        controller.set_initial_guess()

    def start_from(self, guess: Array) -> None:
        """Commands (N, 2) from which the next solve starts; do-mpc keeps its own guess of everything else."""
        self._controller.u0 = guess[0]

    def solve(self, problem: Problem) -> float:
        """One step of the controller; do-mpc does not hand its cost out."""
        self._problem = problem
        self._controller.make_step(problem.start.reshape(-1, 1))
        found = self._controller.opt_x_num
        self.commands = np.array([np.asarray(found["_u", stage, 0]).ravel() for stage in range(self._horizon)])
        return float("nan")

    def _varying(self, _time: float) -> Any:
        problem, template = self._problem, self._template
        parameters: MotionParameters = problem.parameters
        numbers, last = parameters.as_array(), problem.weight_array()[STAGE_COUNT:]
        for stage in range(self._horizon + 1):
            template["_tvp", stage, "reference"] = problem.state_reference[stage]
            template["_tvp", stage, "target"] = problem.input_reference[min(stage, self._horizon - 1)]
            template["_tvp", stage, "parameters"] = numbers
            template["_tvp", stage, "last"] = last
        return template
