"""A drive to goals in the simulated world, closed through the stack's own objects, in lock-step and without ROS."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from sim_bridge.simulator import Simulator, SimulatorSettings
from sim_bridge.world import World
from tracked_description import Robot
from tracked_lab.steering import NmpcLayers
from tracked_lab.tuning import NodeParameters
from tracked_localization import OdometryFilter, OdometryFilterSettings, SlipSettings
from tracked_localization.localisation.localiser import Localised, Localiser, LocaliserSettings
from tracked_localization.matching.pose_history import PoseHistory
from tracked_localization.matching.scan_matcher import MatchSettings
from tracked_localization.matching.scan_points import scan_points
from tracked_localization.matching.wall_field import WallField
from tracked_navigation.band import BandSettings, TimedElasticBand
from tracked_navigation.movers.mover_tracker import MoverSettings
from tracked_navigation.navigator import Finished, Navigator, NavigatorOutput, NavigatorSettings
from tracked_navigation.planning.costmap import CostSettings
from tracked_navigation.planning.zones import Zones
from tracked_safety import ArbiterSettings, CommandArbiter, CommandRefused
from tracked_types import BodyState, LaserScan, OccupancyMap, Odometry, Pose2, PoseSample, VelocityCommand

_PIPELINE_LATENCY_S = 0.1


@dataclass(slots=True)
class Moment:
    """What happened in one tick of the simulator."""

    stamp_ns: int
    truth: BodyState | None = None
    odometry: Odometry | None = None
    localised: Localised | None = None
    output: NavigatorOutput | None = None
    command: VelocityCommand | None = None
    finished: Finished | None = field(default=None)


class GoalDrive:
    """Simulator, odometry filter, localiser, navigator, NMPC layers and arbiter of one robot.

    map and world share one frame. The robot knows at the beginning where it is.
    """

    def __init__(
        self,
        robot: Robot,
        world: World,
        occupancy_map: OccupancyMap,
        *,
        seed: int,
        start: Pose2,
        parameters: NodeParameters | None = None,
        zones: Zones | None = None,
    ) -> None:
        parameters = parameters or {}
        self.robot, self.world = robot, world
        self.simulator = Simulator(robot, world, SimulatorSettings(), seed=seed, start=start)
        self.filter = OdometryFilter(OdometryFilterSettings.from_robot(robot, SlipSettings.from_robot(robot)))
        self.filter.expect_poses()
        self._history = PoseHistory()
        self._lidar = Pose2(robot.lidar.xyz_m[0], robot.lidar.xyz_m[1], robot.lidar.rpy_rad[2])
        matching = MatchSettings()
        self.localiser = Localiser(
            LocaliserSettings(), matching, WallField(occupancy_map), start, np.diag([1e-4, 1e-4, 1e-4])
        )
        self._anchor = start  # the odometry begins where the robot stands
        self._odom_in_map: Pose2 | None = start
        self.navigator = Navigator(
            NavigatorSettings(**parameters.get("navigator", {})),
            TimedElasticBand(BandSettings.from_robot(robot)),
            CostSettings.from_robot(robot),
            MoverSettings(),
            zones,
        )
        self.navigator.set_map(occupancy_map)
        steering = {"upper_nmpc": {"pipeline_latency_s": _PIPELINE_LATENCY_S, **parameters.get("upper_nmpc", {})}}
        self.steering = NmpcLayers.from_parameters(robot, steering | {"lower_nmpc": parameters.get("lower_nmpc", {})})
        self.arbiter = CommandArbiter(ArbiterSettings.from_robot(robot))

    def drive(self, goals: Sequence[Pose2], *, limit_s: float) -> Iterator[Moment]:
        """Moments until the navigator says how it ended, or ``limit_s`` of simulated time have passed."""
        asked = False
        end_ns = self.simulator.stamp_ns + round(limit_s * 1e9)
        while self.simulator.stamp_ns < end_ns:
            if not asked and self._history.newest_ns is not None:
                self.navigator.go(goals)
                asked = True
            moment = self._tick()
            yield moment
            if moment.finished is not None:
                return

    def close(self) -> None:
        """Free the world."""
        self.simulator.close()

    def _tick(self) -> Moment:
        batch = self.simulator.advance()
        moment = Moment(batch.stamp_ns, batch.truth[0] if batch.truth else None)
        estimates = [*(found for sample in batch.imu for found in self.filter.add_imu(sample))]
        estimates += [found for sample in batch.tracks for found in self.filter.add_tracks(sample)]
        for estimate in estimates:
            self._react(estimate.odometry, estimate.slip, moment)
        for scan in batch.scans:
            self._localise(scan, moment)
        return moment

    def _react(self, odometry: Odometry, slip: object, moment: Moment) -> None:
        moment.odometry = odometry
        self._history.add(odometry)
        stopped = self.arbiter.tick(odometry.stamp_ns)
        output = self.navigator.update(odometry, self._odom_in_map)
        if output is not None:
            moment.output, moment.finished = output, output.finished
            if output.reference is not None:
                self.steering.set_reference(output.reference)
        self.steering.set_slip(slip)  # type: ignore[arg-type]
        steered = self.steering.update(odometry)
        sent = stopped
        if steered is not None and steered.command is not None:
            try:
                sent = self.arbiter.offer("nav", steered.command)
            except CommandRefused:
                sent = None
        if sent is not None:
            moment.command = sent
            self.steering.set_sent(sent)
            self.simulator.submit(sent)

    def _localise(self, scan: LaserScan, moment: Moment) -> None:
        points = scan_points(scan, self._lidar, self._history, height_m=self.robot.lidar.xyz_m[2])
        placed = self._history.at(np.array([points.stamp_ns], np.int64))
        if placed is None:
            return
        odom_pose = Pose2(*placed[0].tolist())
        moment.localised = found = self.localiser.add(points, odom_pose)
        self._odom_in_map = None if found.lost else found.odom_in_map
        if found.used:
            sample = self._measured(found)
            self.filter.add_pose(sample)
        self.navigator.see(points, found.pose)

    def _measured(self, found: Localised) -> PoseSample:
        """The match as a measurement in the odometry's frame."""
        pose = self._anchor.inverse().compose(found.match.pose)
        floor = np.diag([0.01**2, 0.01**2, 0.004**2])
        values, axes = np.linalg.eigh(found.match.information)
        spread = axes @ np.diag(1.0 / np.maximum(values, 1e-2)) @ axes.T + floor
        back = -self._anchor.yaw_rad
        turn = np.array([[math.cos(back), -math.sin(back), 0], [math.sin(back), math.cos(back), 0], [0, 0, 1.0]])
        covariance = turn @ spread @ turn.T
        return PoseSample(found.stamp_ns, "odom", pose, 0.5 * (covariance + covariance.T))
