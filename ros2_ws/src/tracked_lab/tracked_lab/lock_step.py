"""Simulator and stack in lock-step: one deterministic thread of events, no clock but simulated time."""

from collections.abc import Callable

from sim_bridge.command_intake import CommandRefused
from sim_bridge.faults import Fault, kind_called, sensor_called
from sim_bridge.floor_plan import floor_plan
from sim_bridge.sensor_suite import SensorBatch
from sim_bridge.simulator import Simulator
from sim_bridge.world import load_world
from tracked_description import Robot, load_robot
from tracked_lab.simulation import make_simulator
from tracked_lab.stack import Reaction, Stack
from tracked_report.describe_run import describe_run
from tracked_report.node_parameters import node_parameters
from tracked_report.run_record import RunRecord
from tracked_report.run_recorder import RunRecorder
from tracked_report.scenario import Fault as PlannedFault
from tracked_report.scenario import Scenario
from tracked_types import seconds_between, to_nanoseconds

Progress = Callable[[float], None]


def drive(
    scenario: Scenario, variant: str, robot: Robot | None = None, *, progress: Progress | None = None
) -> RunRecord:
    """Run one variant of a scenario to its end and return everything that happened.

    ``progress`` is told the simulated time (s) after every tick. The same scenario, variant and seed give
    the same record, bit for bit, solver times excepted.

    Raises
    ------
    KeyError: for an unknown variant.
    UnknownParameterError, CheckedFileError, ValueError: if the scenario asks for what does not exist.
    """
    robot = robot or load_robot(scenario.robot)
    parameters = node_parameters(scenario, variant)
    stack = Stack(robot, parameters)
    simulator = make_simulator(robot, parameters.get("sim_bridge", {}))
    recorder = RunRecorder()
    try:
        for planned in scenario.faults:
            simulator.inject(_fault(planned))
        end_s = scenario.duration_s
        while (now_s := seconds_between(simulator.stamp_ns, 0)) < end_s:
            _tick(simulator, stack, recorder)
            if progress is not None:
                progress(now_s)
    finally:
        simulator.close()
    meta = describe_run(scenario, variant, robot, floor_plan(load_world(scenario.world)))
    start = simulator.start
    odom_in_world = (start.x_m, start.y_m, start.yaw_rad)
    return recorder.record(meta.model_copy(update={"time": "lock_step", "odom_in_world": odom_in_world}))


def _fault(planned: PlannedFault) -> Fault:
    start_ns = to_nanoseconds(planned.at_s)
    end_ns = None if planned.duration_s is None else start_ns + to_nanoseconds(planned.duration_s)
    return Fault(sensor_called(planned.target), kind_called(planned.kind), start_ns, end_ns, planned.value)


def _tick(simulator: Simulator, stack: Stack, recorder: RunRecorder) -> None:
    batch = simulator.advance()
    _record_truth(recorder, batch)
    estimates = [estimate for sample in batch.imu for estimate in stack.filter.add_imu(sample)]
    estimates += [estimate for sample in batch.tracks for estimate in stack.filter.add_tracks(sample)]
    for estimate in estimates:
        reaction = stack.react(estimate)
        _record(recorder, reaction)
        if reaction.sent is not None:
            try:
                simulator.submit(reaction.sent)
            except CommandRefused as refusal:
                recorder.add_event(simulator.stamp_ns, "sim_bridge", refusal.reason)


def _record_truth(recorder: RunRecorder, batch: SensorBatch) -> None:
    for state in batch.truth:
        recorder.add("truth", state)
        recorder.add("acceleration", state)
    for slip in batch.truth_slip:
        recorder.add("truth_slip", slip)
    for sample in batch.tracks:
        recorder.add("tracks", sample)


def _record(recorder: RunRecorder, reaction: Reaction) -> None:
    recorder.add("odometry", reaction.estimate.odometry)
    recorder.add("slip", reaction.estimate.slip)
    named = {
        "reference": reaction.player.reference,
        "goal_reached": reaction.player.reached,
        "upper_plan": reaction.upper.trajectory if reaction.upper else None,
        "upper_status": reaction.upper.status if reaction.upper else None,
        "lower_status": reaction.lower.status if reaction.lower else None,
        "cmd_vel_nav": reaction.asked,
        "cmd_vel": reaction.sent,
    }
    for channel, value in named.items():
        if value is not None:
            recorder.add(channel, value)
    if reaction.refused:
        recorder.add_event(reaction.estimate.odometry.stamp_ns, "command_arbiter", f"refused: {reaction.refused}")
