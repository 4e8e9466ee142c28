"""A drive to goals in the simulated world, closed through the stack's own objects, in lock-step and without ROS."""

import contextlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from sim_bridge.simulator import Simulator, SimulatorSettings
from sim_bridge.world import World
from tracked_description import Robot
from tracked_lab.steering import NmpcLayers
from tracked_lab.tuning import NodeParameters
from tracked_localization import OdometryFilter, OdometryFilterSettings, SlipSettings
from tracked_localization.localisation.global_search import SearchSettings
from tracked_localization.localisation.localiser import LocaliserSettings
from tracked_localization.localisation.odometry_anchor import AnchorSettings
from tracked_localization.localisation.robot_on_map import OnMap, Phase, RobotOnMap, RobotOnMapSettings
from tracked_localization.matching.scan_alignment import AlignedScan, ScanAlignment
from tracked_localization.matching.scan_matcher import MatchSettings
from tracked_navigation.band import BandSettings, TimedElasticBand
from tracked_navigation.movers.mover_tracker import MoverSettings
from tracked_navigation.navigator import Finished, Navigator, NavigatorOutput, NavigatorSettings
from tracked_navigation.planning.costmap import CostSettings
from tracked_navigation.planning.zones import Zones
from tracked_safety import ArbiterSettings, CollisionGuard, CommandArbiter, CommandRefused, GuardSettings
from tracked_types import (
    PIPELINE_LATENCY_S,
    BodyState,
    OccupancyMap,
    Odometry,
    Pose2,
    Slip,
    VelocityCommand,
    to_nanoseconds,
)


@dataclass(slots=True)
class Moment:
    """What happened in one tick of the simulator."""

    stamp_ns: int
    truth: BodyState | None = None
    odometry: Odometry | None = None
    on_map: OnMap | None = None
    output: NavigatorOutput | None = None
    command: VelocityCommand | None = None
    finished: Finished | None = None


class GoalDrive:
    """Simulator, odometry filter, localiser, navigator, NMPC layers and arbiter with guard of one robot.

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
        self._alignment = ScanAlignment.of_robot(robot)
        on_map = RobotOnMapSettings(correct_odometry=True)
        self.localiser = RobotOnMap(on_map, LocaliserSettings(), MatchSettings(), SearchSettings(), AnchorSettings())
        self.localiser.set_map(occupancy_map)
        self.localiser.set_pose(start)
        self._odom_in_map: Pose2 | None = None
        self.navigator = Navigator(
            NavigatorSettings(**parameters.get("navigator", {})),
            TimedElasticBand(BandSettings.from_robot(robot)),
            CostSettings.from_robot(robot),
            MoverSettings(),
            zones,
        )
        self.navigator.set_map(occupancy_map)
        steering = {"upper_nmpc": {"pipeline_latency_s": PIPELINE_LATENCY_S, **parameters.get("upper_nmpc", {})}}
        self.steering = NmpcLayers.from_parameters(robot, steering | {"lower_nmpc": parameters.get("lower_nmpc", {})})
        guard = CollisionGuard(GuardSettings.from_robot(robot))
        self.arbiter = CommandArbiter(ArbiterSettings.from_robot(robot), guard, lock_step=True)

    def drive(self, goals: Sequence[Pose2], *, limit_s: float) -> Iterator[Moment]:
        """Moments until the navigator says how it ended, or ``limit_s`` of simulated time have passed."""
        asked = False
        end_ns = self.simulator.stamp_ns + to_nanoseconds(limit_s)
        while self.simulator.stamp_ns < end_ns:
            if not asked and self.localiser.phase is Phase.LOCALISED:
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
        estimates = [found for sample in batch.imu for found in self.filter.add_imu(sample)]
        estimates += [found for sample in batch.tracks for found in self.filter.add_tracks(sample)]
        for estimate in estimates:
            self._react(estimate.odometry, estimate.slip, moment)
        for scan in batch.scans:
            self._take(self._alignment.add_scan(scan), moment)
            self._send(self.arbiter.add_scan(scan), moment)
        return moment

    def _react(self, odometry: Odometry, slip: Slip, moment: Moment) -> None:
        moment.odometry = odometry
        self._take(self._alignment.add_odometry(odometry), moment)
        self.localiser.work(odometry.stamp_ns)
        self._send(self.arbiter.add_odometry(odometry), moment)
        output = self.navigator.update(odometry, self._odom_in_map)
        if output is not None:
            moment.output, moment.finished = output, output.finished
            if output.reference is not None:
                self.steering.set_reference(output.reference)
        self.steering.set_slip(slip)
        steered = self.steering.update(odometry)
        if steered is not None and steered.command is not None:
            with contextlib.suppress(CommandRefused):
                self._send(self.arbiter.offer("nav", steered.command), moment)

    def _send(self, sent: VelocityCommand | None, moment: Moment) -> None:
        """To the base, and word of it to the steering."""
        if sent is not None:
            moment.command = sent
            self.steering.set_sent(sent)
            self.simulator.submit(sent)

    def _take(self, scans: list[AlignedScan], moment: Moment) -> None:
        for scan in scans:
            found = self.localiser.add(scan)
            known = found is not None and self.localiser.phase is Phase.LOCALISED
            moment.on_map = found
            self._odom_in_map = found.odom_in_map if found is not None and known else None
            if found is not None and found.measured is not None:
                self.filter.add_pose(found.measured)
            if self._odom_in_map is not None:
                self.navigator.see(scan.points, self._odom_in_map.compose(scan.odom_pose))
