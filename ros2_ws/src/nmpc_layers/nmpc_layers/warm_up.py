"""Compiles the code of every solver that the default layers use: ``python -m nmpc_layers.warm_up``.

Set-up runs it once, so that no node compiles anything at its first start.
"""

import sys
import time
import warnings
from collections.abc import Callable

from nmpc_layers.drive_limits import DriveLimits
from nmpc_layers.lower_settings import LowerSettings
from nmpc_layers.solver import BoxSolver, Motion, SolverCodeWarning, TrackSolver
from nmpc_layers.upper_settings import UpperSettings
from tracked_description import load_robot

Solver = BoxSolver | TrackSolver


def default_solvers() -> dict[str, Callable[[], Solver]]:
    """Makers of the solvers of both layers, both methods and both kinds of limits, by name."""
    robot = load_robot()
    upper, lower = UpperSettings.from_robot(robot).horizon, LowerSettings.from_robot(robot).horizon
    tracks = DriveLimits.from_robot(robot).tracks
    return {
        f"upper layer, N={upper}": lambda: BoxSolver(Motion.KINEMATIC, upper),
        f"lower layer improved, N={lower}": lambda: BoxSolver(Motion.LAG, lower),
        f"lower layer thesis, N={lower}": lambda: BoxSolver(Motion.KINEMATIC, lower),
        f"lower layer improved with track limits, N={lower}": lambda: TrackSolver(Motion.LAG, lower, tracks),
        f"lower layer thesis with track limits, N={lower}": lambda: TrackSolver(Motion.KINEMATIC, lower, tracks),
    }


def main() -> int:
    """Build everything with one line per solver; 1 if something had to fall back to the interpreter."""
    interpreted = 0
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SolverCodeWarning)
        for name, make in default_solvers().items():
            began_s = time.monotonic()
            reason = make().interpreter_reason
            interpreted += bool(reason)
            print(f"{name}: {reason or f'ready after {time.monotonic() - began_s:.1f} s'}", flush=True)
    return 1 if interpreted else 0


if __name__ == "__main__":
    sys.exit(main())
