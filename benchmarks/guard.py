"""Collision guard in the simulated world: reaction, obstacles thrown in before the driving robot, speed of what is hit.

Belts, lidar, odometry filter, arbiter and guard run in lock-step in one process. The robot drives straight ahead, back,
in arcs or turns on the spot, on floors of varied friction; at a random instant an obstacle stands in its way. Ways are
along the true arc until the robot's outline would touch. The braking distance is v^2 / 2a with the braking of
robot.yaml: what the robot needs after it has begun to brake, without the time until it knows. Contacts are judged by
the true pose and the outline of belts and chassis.

What cannot be avoided is held against the slowest contact that the belts permit: full speed until the first scan that
shows the obstacle is complete, the transport delay, then the belts' limit of acceleration and their lag. Close to a
stop a millimetre decides on centimetres per second, and body and ground give way a little: so also against an obstacle
that stands 1 cm nearer.
"""

import argparse
import math
from dataclasses import dataclass

import numpy as np
from guard_obstacles import Thing, pace_of, placing, random_thing, slowest_contact, way_to
from numpy.typing import NDArray

from sim_bridge.sensor_suite import SensorBatch
from sim_bridge.simulator import Simulator
from sim_bridge.world import load_world
from sim_bridge.world_control import WorldControl
from tracked_description import Footprint, Robot, load_robot
from tracked_localization import OdometryFilter, OdometryFilterSettings, SlipSettings
from tracked_report.results import write_metrics
from tracked_safety import ArbiterSettings, CollisionGuard, CommandArbiter, GuardSettings
from tracked_types import LaserScan, PeriodGrid, Pose2, Twist2, VelocityCommand, seconds_between

Array = NDArray[np.float64]
SEED = 5
BEYOND_M = 0.10  # the braking distance
RUN_UP_S, AFTERMATH_S = 1.2, 1.3
HEIGHT_M = 0.5
SEEN_M = 1.2  # a return from nearer than this is the obstacle: a pitching robot's beams meet the floor farther away
NEARER_M = 0.01
THING = "thing"


@dataclass(frozen=True, slots=True)
class Trial:
    """What happened to one obstacle. Ways in metres, speeds in m/s of the base or of a corner where it turns."""

    pace_mps: float
    way_m: float
    reaction_s: float
    left_m: float
    contact_mps: float | None
    bound_mps: float
    nearer_bound_mps: float


class Track:
    """One robot that goes from trial to trial on an endless floor."""

    def __init__(self, robot: Robot, seed: int) -> None:
        self._robot = robot
        self._random = np.random.default_rng(np.random.SeedSequence([seed, 0x6775]))
        self._simulator = Simulator(robot, load_world("flat"), seed=seed)
        self._world = WorldControl(self._simulator)
        slip = SlipSettings.from_robot(robot)
        self._filter = OdometryFilter(OdometryFilterSettings.from_robot(robot, slip))
        guard = CollisionGuard(GuardSettings.from_robot(robot))
        self._arbiter = CommandArbiter(ArbiterSettings.from_robot(robot), guard, lock_step=True)
        self._control = PeriodGrid(robot.control.rate_hz)
        self._footprint = Footprint.from_robot(robot)
        self._wanted = Twist2(0.0, 0.0)
        self._sent: list[VelocityCommand] = []
        self._scans: list[LaserScan] = []

    def close(self) -> None:
        """Free the world."""
        self._simulator.close()

    def trial(self, beyond_m: tuple[float, float]) -> Trial:
        """Drive, throw an obstacle in at the braking distance and somewhat (between ``beyond_m``) more, and look."""
        random, simulator = self._random, self._simulator
        self._world.set_friction("", random.uniform(0.4, 0.9), random.uniform(0.35, 0.8))
        self._wanted = _twist(random)
        self._run(RUN_UP_S + random.uniform(0.0, 0.1))
        for _ in range(int(random.integers(0, 4))):  # at any step of the physics, not only when sensors speak
            if (batch := simulator.step()) is not None:
                self._take(batch)
        moving, pose = self._motion()
        steady = self._sent[-1].twist
        pace = pace_of(moving)
        way_m = max(pace**2 / (2.0 * self._robot.limits.braking_mps2) + random.uniform(*beyond_m), 0.01)
        thing, there, way_m = self._throw(moving, pose, way_m)
        thrown_ns, count, scans = simulator.stamp_ns, len(self._sent), len(self._scans)
        outline = thing.outline(there)
        contact_mps, left_m = None, math.inf
        end_ns = thrown_ns + round(AFTERMATH_S * 1e9)
        while simulator.stamp_ns < end_ns:
            self._take(simulator.advance())
            now, at = self._motion()
            left_m = min(left_m, float(self._footprint.distance(at.inverse().transform(outline)).min()))
            if left_m <= 0.0 and contact_mps is None:
                contact_mps = pace_of(now)
                end_ns = simulator.stamp_ns + round(0.25 * 1e9)  # by then a scan shows it, whatever is hit
        self._world.delete(THING)
        first = next((scan for scan in self._scans[scans:] if (scan.ranges_m < SEEN_M).any()), None)
        slower = next((sent for sent in self._sent[count:] if _is_slower(sent.twist, steady)), None)
        known_s = math.inf if first is None else seconds_between(first.stamp_ns, thrown_ns) + first.scan_time_s
        reaction_s = math.inf
        if first is not None and slower is not None:
            reaction_s = seconds_between(slower.stamp_ns, first.stamp_ns)
        bound_mps, nearer_mps = (
            slowest_contact(self._robot, steady, moving, way_m - short_m, known_s) for short_m in (0.0, NEARER_M)
        )
        if contact_mps is not None:
            self._wanted = Twist2(0.0, 0.0)
            self._run(0.6)
        return Trial(pace, way_m, reaction_s, left_m, contact_mps, bound_mps, nearer_mps)

    def _run(self, seconds: float) -> None:
        end_ns = self._simulator.stamp_ns + round(seconds * 1e9)
        while self._simulator.stamp_ns < end_ns:
            self._take(self._simulator.advance())

    def _take(self, batch: SensorBatch) -> None:
        """What the graph does in lock-step with what the sensors deliver at one tick."""
        for scan in batch.scans:
            self._scans.append(scan)
            self._submit(self._arbiter.add_scan(scan))
        estimates = [estimate for sample in batch.imu for estimate in self._filter.add_imu(sample)]
        estimates += [estimate for sample in batch.tracks for estimate in self._filter.add_tracks(sample)]
        for estimate in estimates:
            odometry = estimate.odometry
            self._submit(self._arbiter.add_odometry(odometry))
            if self._control.is_instant(odometry.stamp_ns):
                self._submit(self._arbiter.offer("nav", VelocityCommand(odometry.stamp_ns, self._wanted)))

    def _submit(self, command: VelocityCommand | None) -> None:
        if command is not None:
            self._sent.append(command)
            self._simulator.submit(command)

    def _motion(self) -> tuple[Twist2, Pose2]:
        state = self._simulator.vehicle.state
        velocity = state.base_velocity_mps
        return Twist2(float(velocity[0]), float(state.angular_velocity_radps[2])), state.base_pose

    def _throw(self, moving: Twist2, pose: Pose2, way_m: float) -> tuple[Thing, Pose2, float]:
        """Put an obstacle where the robot would touch it after ``way_m``; the way that it is, to 4 mm."""
        while True:
            thing = random_thing(self._random)
            place = placing(self._random, moving, self._footprint, thing)
            low, high = 0.0, 1.5
            for _ in range(20):
                middle = 0.5 * (low + high)
                found_m = way_to(thing.outline(place(middle)), moving, self._footprint, way_m + 0.1)
                low, high = (middle, high) if found_m < way_m else (low, middle)
            found_m = way_to(thing.outline(place(high)), moving, self._footprint, way_m + 0.1)
            if found_m - way_m < 0.004:
                break  # not one that the robot would pass beside
        there = pose.compose(place(high))
        size, position = (thing.along_m, thing.across_m, HEIGHT_M), (there.x_m, there.y_m, 0.5 * HEIGHT_M)
        self._world.spawn(THING, thing.shape, size, 0.0, position, (0.0, 0.0, there.yaw_rad))
        return thing, there, found_m


def _twist(random: np.random.Generator) -> Twist2:
    """A tenth turns on the spot, a quarter goes back; four in ten of what moves goes straight."""
    kind = random.uniform()
    if kind < 0.1:
        return Twist2(0.0, float(random.choice([-1.0, 1.0]) * random.uniform(0.6, 1.3)))
    speed = random.uniform(0.2, 0.5) if kind < 0.75 else -random.uniform(0.2, 0.4)
    turn = 0.0 if random.uniform() < 0.4 else random.uniform(-1.0, 1.0)
    return Twist2(float(speed), float(turn))


def _is_slower(twist: Twist2, than: Twist2) -> bool:
    slower = abs(than.speed_mps) - abs(twist.speed_mps) > 1e-6
    return slower or abs(than.yaw_rate_radps) - abs(twist.yaw_rate_radps) > 1e-6


def trials(robot: Robot, seed: int, count: int, beyond_m: tuple[float, float]) -> list[Trial]:
    """So many obstacles, one after the other."""
    track = Track(robot, seed)
    try:
        return [track.trial(beyond_m) for _ in range(count)]
    finally:
        track.close()


def main() -> None:
    """Measure, print, write out/guard/metrics.json."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--quick", action="store_true", help="few obstacles: shows that it works, not how well")
    parser.add_argument("--seed", type=int, default=SEED)
    arguments = parser.parse_args()
    robot = load_robot()
    far = trials(robot, arguments.seed, 20 if arguments.quick else 200, (BEYOND_M, BEYOND_M))
    near = trials(robot, arguments.seed + 1, 10 if arguments.quick else 100, (-0.08, BEYOND_M - 0.02))
    hit = [trial for trial in near if trial.contact_mps is not None]
    avoidable = [trial for trial in hit if trial.nearer_bound_mps == 0.0]
    nearer = [trial.contact_mps - trial.nearer_bound_mps for trial in hit if trial.contact_mps is not None]
    excess = [trial.contact_mps - trial.bound_mps for trial in hit if trial.contact_mps is not None]
    share = [trial.contact_mps / trial.pace_mps for trial in hit if trial.contact_mps is not None]
    figures = {
        "reaction_worst_ms": 1e3 * max(trial.reaction_s for trial in far + near),
        "far.obstacles": float(len(far)),
        "far.contacts": float(sum(trial.contact_mps is not None for trial in far)),
        "far.least_left_mm": 1e3 * min(trial.left_m for trial in far),
        "far.median_left_mm": 1e3 * float(np.median([trial.left_m for trial in far])),
        "near.obstacles": float(len(near)),
        "near.contacts": float(len(hit)),
        "near.avoidable_contacts": float(len(avoidable)),
        "near.excess_worst_mps": max(excess, default=0.0),
        "near.excess_of_1_cm_worst_mps": max(nearer, default=0.0),
        "near.excess_median_mps": float(np.median(excess)) if excess else 0.0,
        "near.contact_share_median": float(np.median(share)) if share else 0.0,
    }
    print(f"reaction: worst {figures['reaction_worst_ms']:.0f} ms after the stamp of the first scan that shows it")
    print(
        f"{len(far)} obstacles {100 * BEYOND_M:.0f} cm beyond the braking distance: "
        f"{figures['far.contacts']:.0f} contacts, "
        f"room left: least {figures['far.least_left_mm']:.0f} mm, median {figures['far.median_left_mm']:.0f} mm"
    )
    print(
        f"{len(near)} nearer ones: {len(hit)} contacts, of which {len(avoidable)} could have been avoided; "
        f"speed at contact above the slowest possible: median {figures['near.excess_median_mps']:.3f} m/s, "
        f"worst {figures['near.excess_worst_mps']:.3f} m/s; above that of an obstacle 1 cm nearer: "
        f"worst {figures['near.excess_of_1_cm_worst_mps']:.3f} m/s"
    )
    write_metrics("guard", {f"guard.{key}": value for key, value in figures.items()}, seed=arguments.seed)


if __name__ == "__main__":
    main()
