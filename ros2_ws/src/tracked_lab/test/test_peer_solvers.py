"""What Fig 5.13 compares solves the same problems."""

import pytest

from nmpc_layers.solver import BoxSolver, Motion
from nmpc_layers.solver.samples import winding_problems
from tracked_lab.dense_gauss_newton import DenseGaussNewton
from tracked_lab.ocp_peers import OptiPeer
from tracked_lab.shooting_solver import ShootingSolver

HORIZON, PERIOD_S = 10, 0.2
PROBLEMS = winding_problems(Motion.KINEMATIC, HORIZON, PERIOD_S, 6, seed=1)


def solved(solver, problem):
    solver.start_from(problem.input_reference)
    return solver.solve(problem)


@pytest.mark.parametrize(
    "make",
    [
        DenseGaussNewton,
        lambda horizon: ShootingSolver("fatrop", horizon),
        lambda horizon: ShootingSolver("sqpmethod", horizon),
        lambda horizon: OptiPeer(Motion.KINEMATIC, horizon),
    ],
)
def test_every_solver_reaches_the_least_cost(make):
    peer, own = make(HORIZON), BoxSolver(Motion.KINEMATIC, HORIZON)
    for problem in PROBLEMS:
        assert solved(peer, problem) == pytest.approx(solved(own, problem).cost, rel=2e-4, abs=1e-6)
