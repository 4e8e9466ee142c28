"""Upper layer: plans along the reference at 5 Hz, (5.2.1)-(5.2.6); alone, it also commands the base."""

import time
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from nmpc_layers.creep import without_creep
from nmpc_layers.goal_approach import GoalApproach, resting_pose
from nmpc_layers.plan_queue import Plan, PlanQueue
from nmpc_layers.plan_shapes import as_trajectory, continuous_headings, step_times, stopping
from nmpc_layers.recent_slips import RecentSlips
from nmpc_layers.sent_commands import GroundModel, SentCommands, predict
from nmpc_layers.solver import BoxSolver, Motion, MotionParameters, Problem, Solution
from nmpc_layers.stop_ramp import StopRamp
from nmpc_layers.upper_settings import UpperSettings, heading_point_of
from tracked_types import (
    Odometry,
    PeriodGrid,
    Pose2,
    Slip,
    SolverStatus,
    StampOrder,
    Trajectory,
    Twist2,
    VelocityCommand,
    seconds_between,
    to_nanoseconds,
)

Array = NDArray[np.float64]
NO_REFERENCE = "no reference yet"
SLIDE_HOLDS_S = 1.0  # it changes slowly


@dataclass(frozen=True, slots=True)
class UpperOutput:
    """What one odometry brought about: a plan that takes effect now, a command (layers single), a tick's outcome."""

    trajectory: Trajectory | None = None
    command: VelocityCommand | None = None
    status: SolverStatus | None = None


class UpperLayer:
    """Nonlinear model predictive control over poses, without slip but for the sideways slide.

    A plan made from the odometry of a 5 Hz instant is handed out with the first odometry that is
    ``pipeline_latency_s`` later, and is stamped with the odometry it was made from.
    """

    def __init__(self, settings: UpperSettings) -> None:
        self.settings = settings
        self.solver = BoxSolver(Motion.KINEMATIC, settings.horizon, use_compiler=settings.compile_solver)
        self.approach = GoalApproach(settings.approach)
        self._parameters = MotionParameters(period_s=settings.period_s, heading_point=heading_point_of(settings.method))
        self._plan_grid = PeriodGrid(settings.rate_hz)
        self._control_grid = PeriodGrid(settings.control_rate_hz)
        self._latency_ns = to_nanoseconds(settings.pipeline_latency_s)
        self._sent = SentCommands(settings.transport_delay_s)
        self._order = StampOrder()
        self._slips = RecentSlips()
        self._reference: Trajectory | None = None
        self._restart()

    def _restart(self) -> None:
        self._plans = PlanQueue()
        self._planned_ns: int | None = None
        self._ramp = StopRamp(self.settings.limits, 1.0 / self.settings.control_rate_hz, self.settings.hold_s)
        self._sent.forget()
        self._slips.forget()
        self.approach.restart()

    @property
    def ignored_odometry(self) -> int:
        """Odometry that came out of order."""
        return self._order.ignored

    def set_reference(self, reference: Trajectory) -> None:
        """The newest piece of reference; one that is not finite is ignored and then counts as missing."""
        if np.isfinite(reference.states).all() and np.isfinite(reference.inputs).all():
            self._reference = reference

    def set_slip(self, slip: Slip) -> None:
        """The newest slip estimate; one that is not finite is ignored. The sideways slide is all that counts here."""
        self._slips.add(slip)

    def set_sent(self, command: VelocityCommand) -> None:
        """A command as it went to the base."""
        self._sent.confirm(command)

    def waits_for_sent(self, stamp_ns: int) -> bool:
        """Whether, in lock-step, a plan at ``stamp_ns`` must wait for word of what became of the last command."""
        if self._order.latest_ns is None or self._order.jumps_back(stamp_ns):
            return False
        plans = self._plan_grid.crossed(self._order.latest_ns, stamp_ns)
        return bool(plans) and self._sent.lacks_word(stamp_ns, self._control_grid)

    def waits_for_slip(self, stamp_ns: int) -> bool:
        """Whether, in lock-step, a plan at ``stamp_ns`` must wait for the slip estimate of the same instant."""
        if not self.settings.knows_slide or self._order.latest_ns is None or self._order.jumps_back(stamp_ns):
            return False
        return bool(self._plan_grid.crossed(self._order.latest_ns, stamp_ns)) and self._slips.lacks(stamp_ns)

    def update(self, odometry: Odometry) -> UpperOutput | None:
        """React to one odometry (planar, in the frame of the reference); None if nothing is due at its stamp.

        Odometry out of order is ignored; a clock that jumps back by more than half a second starts over.
        """
        if self._order.jumps_back(odometry.stamp_ns):
            self._reference = None
            self._restart()
        if not self._order.advance(odometry.stamp_ns):
            return None
        status = None
        if self._plan_grid.crossed(self._order.previous_ns, odometry.stamp_ns):
            status = self._plan(odometry)
        trajectory = self._plans.release(odometry.stamp_ns)
        command = None
        if self.settings.layers == "single" and self._control_grid.crossed(self._order.previous_ns, odometry.stamp_ns):
            command = self._command(odometry.stamp_ns)
        if status is None and trajectory is None and command is None:
            return None
        return UpperOutput(trajectory, command, status)

    def _plan(self, odometry: Odometry) -> SolverStatus:
        began_s = time.thread_time()  # a stop watch for the status; no decision depends on it
        solution, reference, effective_ns = None, self._reference, odometry.stamp_ns + self._latency_ns
        reason = self._missing(odometry)
        if not reason and reference is not None:
            solution = self._solve(self._problem(odometry, reference), odometry.stamp_ns)
            reason = "" if solution.converged else solution.outcome.value
        if solution is not None and solution.converged:
            twist = without_creep(Twist2(*solution.commands[0].tolist()))
            self._plans.add(Plan(effective_ns, self._as_trajectory(odometry, solution), twist))
        elif reference is not None and _is_finite(odometry):
            self._plans.add(Plan(effective_ns, self._stopping(odometry), None))
        return SolverStatus(
            stamp_ns=odometry.stamp_ns,
            layer="upper",
            ok=not reason,
            reason=reason,
            iterations=solution.iterations if solution else 0,
            cost=solution.cost if solution else 0.0,
            cpu_time_s=time.thread_time() - began_s,
        )

    def _missing(self, odometry: Odometry) -> str:
        """Which input is missing, in words; empty if none."""
        if not _is_finite(odometry):
            return "odometry is not finite"
        if self._reference is None:
            return NO_REFERENCE
        age_s = seconds_between(odometry.stamp_ns, self._reference.stamp_ns)
        if abs(age_s) <= self.settings.reference_timeout_s:
            return ""
        # A reference that has come to rest says everything there is to say about later times.
        if age_s > 0.0 and resting_pose(self._reference, odometry.stamp_ns, odometry.stamp_ns, 0.0) is not None:
            return ""
        return f"reference is {abs(age_s):.2f} s {'old' if age_s > 0.0 else 'ahead of the odometry'}"

    def _problem(self, odometry: Odometry, reference: Trajectory) -> Problem:
        settings = self.settings
        start_ns = odometry.stamp_ns + to_nanoseconds(settings.horizon_start_s)
        if settings.final_approach:
            horizon_s = settings.horizon * settings.period_s
            reference = self.approach.reference(reference, odometry, start_ns, horizon_s)
        # The slip-free model of this layer takes the measured yaw rate for that of the belts.
        commands = self._sent.in_force(odometry.stamp_ns, start_ns, before_ns=odometry.stamp_ns)
        slip = self._slips.at(odometry.stamp_ns, SLIDE_HOLDS_S)[0] if settings.knows_slide else None
        slide_s = slip.slide_s if slip is not None else 0.0
        ground = GroundModel(lag_s=settings.motor_lag_s, slide_s=slide_s)
        pose, _ = predict(odometry.pose, odometry.twist, commands, ground)
        offsets = step_times(settings.period_s, settings.horizon)
        states, inputs = reference.at(start_ns, offsets)
        if settings.method == "improved":
            _, inputs = reference.at(start_ns, offsets + 0.5 * settings.period_s)
        certified = settings.certified
        return Problem(
            start=pose.as_array(),
            state_reference=continuous_headings(states, pose.yaw_rad),
            input_reference=inputs[:-1],
            low=settings.limits.low,
            high=settings.limits.high,
            parameters=replace(self._parameters, slide_s=slide_s),
            weights=settings.weights,
            terminal=certified.weight if certified is not None and certified.covers(inputs[-1]) else None,
        )

    def _solve(self, problem: Problem, stamp_ns: int) -> Solution:
        if self._planned_ns is None:
            self.solver.start_from(problem.input_reference)
        else:
            elapsed_s = seconds_between(stamp_ns, self._planned_ns)
            self.solver.shift(round(min(elapsed_s, 60.0) / self.settings.period_s))
        solution = self.solver.solve(problem)
        self._planned_ns = stamp_ns if solution.converged else None
        return solution

    def _times(self) -> Array:
        return step_times(self.settings.period_s, self.settings.horizon, self.settings.horizon_start_s)

    def _as_trajectory(self, odometry: Odometry, solution: Solution) -> Trajectory:
        return as_trajectory(odometry.stamp_ns, odometry.frame_id, self._times(), solution.states, solution.commands)

    def _stopping(self, odometry: Odometry) -> Trajectory:
        """Plan for the lower layer while there is no solution: it goes on for a moment, then brakes."""
        horizon_s = self.settings.horizon * self.settings.period_s
        times = np.arange(0.0, horizon_s + 0.025, 0.05)
        hold_s = self.settings.hold_s + self.settings.pipeline_latency_s
        pose, twist = odometry.pose, self.settings.limits.clipped(odometry.twist)
        return stopping(odometry.stamp_ns, odometry.frame_id, times, pose, twist, self.settings.limits, hold_s)

    def _command(self, stamp_ns: int) -> VelocityCommand | None:
        """Hold the first command of the effective plan; without one, or with one overdue, ramp down."""
        plan = self._plans.effective
        if plan is None:
            return None
        overdue_s = seconds_between(stamp_ns, plan.effective_ns) - self.settings.period_s
        if plan.twist is not None and overdue_s <= self.settings.hold_s:
            self._ramp.accept(plan.twist)
            twist = plan.twist
        else:
            twist = self._ramp.next()
        command = VelocityCommand(stamp_ns, twist)
        self._sent.add(command)
        return command


def _is_finite(odometry: Odometry) -> bool:
    pose: Pose2 = odometry.pose
    values = (pose.x_m, pose.y_m, pose.yaw_rad, odometry.twist.speed_mps, odometry.twist.yaw_rate_radps)
    return bool(np.isfinite(values).all())
