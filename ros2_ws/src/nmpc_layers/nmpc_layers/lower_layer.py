"""Lower layer: follows the upper layer's plan at 30 Hz and makes good the slip, (5.2.12)-(5.2.14)."""

import time
from dataclasses import dataclass

import numpy as np

from nmpc_layers.creep import without_creep
from nmpc_layers.lower_problem import make_problem
from nmpc_layers.lower_settings import LowerSettings
from nmpc_layers.plan_shapes import as_trajectory, step_times
from nmpc_layers.recent_slips import RecentSlips
from nmpc_layers.sent_commands import SentCommands
from nmpc_layers.solver import BoxSolver, Problem, Solution, TrackSolver
from nmpc_layers.stop_ramp import StopRamp
from tracked_types import (
    Odometry,
    PeriodGrid,
    Slip,
    SolverStatus,
    StampOrder,
    Trajectory,
    Twist2,
    VelocityCommand,
    clock_set_back,
    seconds_between,
    to_nanoseconds,
)

NO_PLAN = "no plan yet"


@dataclass(frozen=True, slots=True)
class LowerOutput:
    """What one tick brought about; without a first plan there is no command, without a solution no prediction."""

    command: VelocityCommand | None
    prediction: Trajectory | None
    status: SolverStatus


class LowerLayer:
    """Nonlinear model predictive control of the belts, ticking on the stamps of the odometry."""

    def __init__(self, settings: LowerSettings) -> None:
        self.settings = settings
        self._problem = make_problem(settings)
        motion, horizon, compile_solver = self._problem.motion, settings.horizon, settings.compile_solver
        self.solver: BoxSolver | TrackSolver
        if settings.constraints == "tracks":
            self.solver = TrackSolver(motion, horizon, settings.limits.tracks, use_compiler=compile_solver)
        else:
            self.solver = BoxSolver(motion, horizon, use_compiler=compile_solver)
        self._grid = PeriodGrid(settings.rate_hz)
        self._plan_grid = PeriodGrid(settings.plan_rate_hz)
        self._sent = SentCommands(settings.transport_delay_s)
        self._order = StampOrder()
        self._slips = RecentSlips()
        self._restart()

    def _restart(self) -> None:
        self._plan: Trajectory | None = None
        self._slips.forget()
        self._solved_index: int | None = None
        self._ramp = StopRamp(self.settings.limits, self.settings.period_s, self.settings.hold_s)
        self._sent.forget()

    @property
    def ignored_odometry(self) -> int:
        """Odometry that came out of order."""
        return self._order.ignored

    def set_plan(self, plan: Trajectory) -> None:
        """The upper layer's newest trajectory; an older or non-finite one is ignored."""
        if not (np.isfinite(plan.states).all() and np.isfinite(plan.inputs).all()):
            return
        latest_ns = plan.stamp_ns if self._plan is None else self._plan.stamp_ns
        if plan.stamp_ns >= latest_ns or clock_set_back(latest_ns, plan.stamp_ns):
            self._plan = plan

    def set_slip(self, slip: Slip) -> None:
        """The newest slip estimate; one that is not finite is ignored and then counts as missing.

        A tick uses that of its own instant, however late it ticks.
        """
        self._slips.add(slip)

    def set_sent(self, command: VelocityCommand) -> None:
        """A command as it went to the base."""
        self._sent.confirm(command)

    def waits_for_plan(self, stamp_ns: int) -> bool:
        """Whether, in lock-step, the tick of ``stamp_ns`` must wait for a plan that is due by then.

        A plan made at a 5 Hz instant is due with the first odometry ``pipeline_latency_s`` later; the first
        such instant is the one after time zero. After the clock has jumped back nothing is waited for.
        """
        if self._order.jumps_back(stamp_ns):
            return False
        made_ns = stamp_ns - to_nanoseconds(self.settings.pipeline_latency_s)
        due_ns = self._plan_grid.stamp_ns(self._plan_grid.index_at(made_ns))
        return due_ns > 0 if self._plan is None else self._plan.stamp_ns < due_ns

    def waits_for_sent(self, stamp_ns: int) -> bool:
        """Whether, in lock-step, the tick of ``stamp_ns`` must wait for word of what became of its last command."""
        return not self._order.jumps_back(stamp_ns) and self._sent.lacks_word_on_newest

    def waits_for_slip(self, stamp_ns: int) -> bool:
        """Whether, in lock-step, the tick of ``stamp_ns`` must wait for the slip estimate of the same instant."""
        needed = self.settings.slip_compensation and not self._order.jumps_back(stamp_ns)
        return needed and self._slips.lacks(stamp_ns)

    def update(self, odometry: Odometry) -> LowerOutput | None:
        """React to one odometry (planar, in the frame of the plan); None if nothing is due at its stamp.

        Odometry out of order is ignored; a clock that jumps back by more than half a second starts over.
        """
        if self._order.jumps_back(odometry.stamp_ns):
            self._restart()
        if not self._order.advance(odometry.stamp_ns):
            return None
        instants = self._grid.crossed(self._order.previous_ns, odometry.stamp_ns)
        if not instants:
            return None
        return self._tick(odometry, instants[-1])

    def _tick(self, odometry: Odometry, index: int) -> LowerOutput:
        began_s = time.thread_time()  # a stop watch for the status; no decision depends on it
        stamp_ns = odometry.stamp_ns
        reason, solution, prediction = self._missing(odometry), None, None
        slip, slip_reason = None, ""
        if self.settings.slip_compensation:
            slip, slip_reason = self._slips.at(stamp_ns, self.settings.slip_timeout_s)
        if not reason and self._plan is not None:
            problem = self._problem.build(odometry, self._plan, slip, self._sent)
            solution = self._solve(problem, index, stamp_ns)
            reason = "" if solution.converged else solution.outcome.value
        if solution is not None and solution.converged:
            twist = without_creep(Twist2(*solution.commands[0].tolist()))
            self._ramp.accept(twist)
            prediction = self._prediction(odometry, solution)
            reason = slip_reason
        else:
            twist = self._ramp.next()
        command = None if self._plan is None else VelocityCommand(stamp_ns, twist)
        if command is not None:
            # Until the arbiter's word of what was sent arrives, this is the best guess.
            self._sent.add(command)
        status = SolverStatus(
            stamp_ns=stamp_ns,
            layer="lower",
            ok=not reason,
            reason=reason,
            iterations=solution.iterations if solution else 0,
            cost=solution.cost if solution else 0.0,
            cpu_time_s=time.thread_time() - began_s,
        )
        return LowerOutput(command, prediction, status)

    def _missing(self, odometry: Odometry) -> str:
        """Which input is missing, in words; empty if none."""
        pose, twist = odometry.pose, odometry.twist
        if not np.isfinite((pose.x_m, pose.y_m, pose.yaw_rad, twist.speed_mps, twist.yaw_rate_radps)).all():
            return "odometry is not finite"
        if self._plan is None:
            return NO_PLAN
        age_s = seconds_between(odometry.stamp_ns, self._plan.stamp_ns)
        if abs(age_s) > self.settings.plan_timeout_s:
            return f"plan is {abs(age_s):.2f} s {'old' if age_s > 0.0 else 'ahead of the odometry'}"
        return ""

    def _solve(self, problem: Problem, index: int, stamp_ns: int) -> Solution:
        if self._solved_index is None:
            self.solver.start_from(problem.input_reference)
        else:
            self.solver.shift(index - self._solved_index)
        if isinstance(self.solver, TrackSolver):
            previous = self._sent.latest_before(stamp_ns)
            solution = self.solver.solve(problem, np.array([previous.speed_mps, previous.yaw_rate_radps]))
        else:
            solution = self.solver.solve(problem)
        self._solved_index = index if solution.converged else None
        return solution

    def _prediction(self, odometry: Odometry, solution: Solution) -> Trajectory:
        times = step_times(self.settings.period_s, self.settings.horizon, self._problem.horizon_start_s)
        return as_trajectory(odometry.stamp_ns, odometry.frame_id, times, solution.states, solution.commands)
