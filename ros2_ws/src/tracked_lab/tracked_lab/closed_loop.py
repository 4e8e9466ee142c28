"""Plant, links and stack in one loop, and the record of what went through it."""

from dataclasses import replace

from sim_bridge.command_intake import CommandRefused
from tracked_lab.conditions import Conditions
from tracked_lab.lidar_pose import LidarPose
from tracked_lab.links import LinkScheduler
from tracked_lab.plant import Plant, PlantBatch
from tracked_lab.stack import Reaction, Stack
from tracked_localization import Estimate
from tracked_report.run_recorder import RunRecorder
from tracked_types import ImuSample, PoseSample, Slip, TrackSample, VelocityCommand


class ClosedLoop:
    """What goes over which link to whom, and into the record.

    Parameters
    ----------
    links: the scheduler that the stack's own links belong to; ideal links by default.
    lidar_pose: measures the pose for the filter; nobody by default.
    oracle_slip: whether the steering gets the true slip.
    """

    def __init__(
        self,
        plant: Plant,
        stack: Stack,
        links: LinkScheduler | None = None,
        *,
        lidar_pose: LidarPose | None = None,
        oracle_slip: bool = False,
    ) -> None:
        self.recorder = RunRecorder()
        self._plant = plant
        self._stack = stack
        self._links = links or LinkScheduler(Conditions().links, 0)
        self._lidar_pose = lidar_pose
        if lidar_pose is not None:
            stack.filter.expect_poses()
        self._oracle = oracle_slip
        self._true_slip: dict[int, Slip] = {}
        self._reactions: list[Reaction] = []

    def tick(self) -> list[Reaction]:
        """One tick of the plant and everything that happens until its end: the stack's reactions."""
        self._reactions = []
        batch = self._plant.advance()
        self._record_truth(batch)
        links = self._links
        links.run_until(batch.stamp_ns)
        for imu in batch.imu:
            links.send("imu", imu, self._hear_imu)
        for tracks in batch.tracks:
            links.send("tracks", tracks, self._hear_tracks)
        if self._lidar_pose is not None:
            for state in batch.truth:
                pose = self._lidar_pose.update(state)
                if pose is not None:
                    links.send_after(self._lidar_pose.latency_ns, "pose", pose, self._hear_pose)
        return self._reactions

    def _hear_imu(self, sample: ImuSample) -> None:
        self._publish(self._stack.filter.add_imu(sample))

    def _hear_tracks(self, sample: TrackSample) -> None:
        self._publish(self._stack.filter.add_tracks(sample))

    def _hear_pose(self, sample: PoseSample) -> None:
        self._publish(self._stack.filter.add_pose(sample))

    def _publish(self, estimates: list[Estimate]) -> None:
        for estimate in estimates:
            self.recorder.add("odometry", estimate.odometry)
            self.recorder.add("slip", estimate.slip)
            self._links.send("estimate", estimate, self._react)

    def _react(self, estimate: Estimate) -> None:
        slip = self._true_slip.get(estimate.odometry.stamp_ns) if self._oracle else None
        if slip is not None:
            shown = estimate.slip
            slip = replace(slip, speed_measured=shown.speed_measured, slide_s=shown.slide_s)
        reaction = self._stack.react(estimate, slip)
        self._reactions.append(reaction)
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
