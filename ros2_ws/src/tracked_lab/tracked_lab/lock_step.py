"""Plant and stack in lock-step: one deterministic thread of events, no clock but simulated time."""

from collections.abc import Callable

from sim_bridge.command_intake import CommandRefused
from sim_bridge.floor_plan import floor_plan
from sim_bridge.world import load_world
from tracked_description import Robot, load_robot
from tracked_lab.conditions import Conditions
from tracked_lab.links import LinkScheduler
from tracked_lab.plant import Plant, PlantBatch
from tracked_lab.plants import make_plant
from tracked_lab.stack import Reaction, Stack
from tracked_lab.steering_registry import steering_of_run
from tracked_localization import Estimate
from tracked_report.describe_run import describe_run
from tracked_report.node_parameters import node_parameters
from tracked_report.run_record import RunRecord
from tracked_report.run_recorder import RunRecorder
from tracked_report.scenario import Scenario
from tracked_types import ImuSample, Slip, TrackSample, VelocityCommand, seconds_between

Progress = Callable[[float], None]


def drive(
    scenario: Scenario,
    variant: str,
    robot: Robot | None = None,
    *,
    conditions: Conditions | None = None,
    progress: Progress | None = None,
) -> RunRecord:
    """Run one variant of a scenario to its end and return everything that happened.

    ``conditions`` are the plain ones by default: belts, ideal links, as the graph drives. ``progress`` is told the
    simulated time (s) after every tick. The same scenario, variant, seed and conditions give the same record, bit
    for bit, solver times excepted.

    Raises
    ------
    KeyError: for an unknown variant.
    UnknownParameterError, UnknownSteeringError, CheckedFileError, ValueError: if the scenario or the conditions ask
        for what does not exist.
    """
    robot = robot or load_robot(scenario.robot)
    conditions = conditions or Conditions()
    parameters = node_parameters(scenario, variant)
    links = LinkScheduler(conditions.links, scenario.seed)
    steering = steering_of_run(
        conditions.steering,
        robot,
        parameters,
        conditions.steering_parameters,
        scenario.seed,
        links.wire("plan"),
    )
    stack = Stack(robot, parameters, steering, links.wire("reference"))
    plant = make_plant(scenario, robot, parameters, conditions)
    run = _Run(plant, stack, links, conditions)
    try:
        end_s = scenario.duration_s
        while (now_s := seconds_between(plant.stamp_ns, 0)) < end_s:
            run.tick()
            if progress is not None:
                progress(now_s)
    finally:
        plant.close()
    meta = describe_run(scenario, variant, robot, floor_plan(load_world(scenario.world)))
    start = plant.start
    odom_in_world = (start.x_m, start.y_m, start.yaw_rad)
    return run.recorder.record(meta.model_copy(update={"time": "lock_step", "odom_in_world": odom_in_world}))


class _Run:
    """What goes over which link to whom, and into the record."""

    def __init__(self, plant: Plant, stack: Stack, links: LinkScheduler, conditions: Conditions) -> None:
        self.recorder = RunRecorder()
        self._plant = plant
        self._stack = stack
        self._links = links
        self._oracle = conditions.slip_source == "oracle"
        self._true_slip: dict[int, Slip] = {}

    def tick(self) -> None:
        """One tick of the plant and everything that happens until its end."""
        batch = self._plant.advance()
        self._record_truth(batch)
        links = self._links
        links.run_until(batch.stamp_ns)
        for imu in batch.imu:
            links.send("imu", imu, self._hear_imu)
        for tracks in batch.tracks:
            links.send("tracks", tracks, self._hear_tracks)

    def _hear_imu(self, sample: ImuSample) -> None:
        self._publish(self._stack.filter.add_imu(sample))

    def _hear_tracks(self, sample: TrackSample) -> None:
        self._publish(self._stack.filter.add_tracks(sample))

    def _publish(self, estimates: list[Estimate]) -> None:
        for estimate in estimates:
            self.recorder.add("odometry", estimate.odometry)
            self.recorder.add("slip", estimate.slip)
            self._links.send("estimate", estimate, self._react)

    def _react(self, estimate: Estimate) -> None:
        slip = self._true_slip.get(estimate.odometry.stamp_ns) if self._oracle else None
        reaction = self._stack.react(estimate, slip)
        self._record(reaction)
        if reaction.sent is not None:
            self._links.send("command", reaction.sent, self._submit)

    def _submit(self, command: VelocityCommand) -> None:
        try:
            self._plant.submit(command)
        except CommandRefused as refusal:
            self.recorder.add_event(self._plant.stamp_ns, "sim_bridge", refusal.reason)

    def _record_truth(self, batch: PlantBatch) -> None:
        for state in batch.truth:
            self.recorder.add("truth", state)
            self.recorder.add("acceleration", state)
        for slip in batch.truth_slip:
            self.recorder.add("truth_slip", slip)
            if self._oracle:
                self._true_slip[slip.stamp_ns] = slip
        for sample in batch.tracks:
            self.recorder.add("tracks", sample)

    def _record(self, reaction: Reaction) -> None:
        add, played, steered = self.recorder.add, reaction.player, reaction.steered
        if played.reference is not None:
            add("reference", played.reference)
        if played.reached is not None:
            add("goal_reached", played.reached)
        if steered is not None:
            if steered.upper is not None and steered.upper.trajectory is not None:
                add("upper_plan", steered.upper.trajectory)
            if steered.upper is not None and steered.upper.status is not None:
                add("upper_status", steered.upper.status)
            status = steered.lower.status if steered.lower is not None else steered.status
            if status is not None:
                add("lower_status", status)
            if steered.command is not None:
                add("cmd_vel_nav", steered.command)
        if reaction.sent is not None:
            add("cmd_vel", reaction.sent)
        if reaction.refused:
            self.recorder.add_event(
                reaction.estimate.odometry.stamp_ns, "command_arbiter", f"refused: {reaction.refused}"
            )
