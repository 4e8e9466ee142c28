"""The physics alone: cost of a step, slip when turning on the spot, and a 40 mm step with and without suspension."""

import argparse
import math
import time
from dataclasses import dataclass

import numpy as np

from sim_bridge.physics_settings import PhysicsSettings
from sim_bridge.track_speeds import track_targets
from sim_bridge.vehicle import Vehicle
from sim_bridge.world import load_world
from tracked_description import Robot, load_robot
from tracked_description.suspension import unit_load_n, x_structure_of
from tracked_report.results import write_metrics
from tracked_report.signals import low_pass, peak, root_mean_square
from tracked_types import Twist2

RATE_HZ = 480
RATES_HZ = (240, 480, 960)
YAW_RATES, QUICK_YAW_RATES = (0.3, 0.5, 0.8, 1.0, 1.3), (0.3, 1.3)
SECONDS, QUICK_SECONDS = 20, 5
CROSSING_SPEED_MPS, CROSSING_SECONDS = 0.3, 9.0
CROSSING_RATE_HZ, FINE_RATE_HZ = 960, 1920
CUTOFF_HZ = 50.0
SOFT_LOAD_RATIO = 0.65
# From the first touch of the front to the rear leaving the step, as distance of the centre from the step's edges.
BEFORE_STEP_M, BEHIND_STEP_M = 0.45, 0.55


@dataclass(frozen=True, slots=True)
class Shake:
    """Vertical acceleration of the chassis while it crosses the step, m/s2."""

    peak_mps2: float
    rms_mps2: float


def step_times_us(robot: Robot, world: str, seconds: int) -> list[float]:
    """Thread CPU time of every physics step of a gentle S-curve (us)."""
    vehicle = Vehicle(robot, load_world(world), PhysicsSettings(physics_rate_hz=RATE_HZ))
    vehicle.step(0.0, 0.0)
    times = []
    for index in range(seconds * RATE_HZ):
        turn = 0.5 if index % (4 * RATE_HZ) < 2 * RATE_HZ else -0.5
        left, right = track_targets(Twist2(0.3, turn), robot.tracks)
        start = time.thread_time()
        vehicle.step(left, right)
        times.append(1e6 * (time.thread_time() - start))
    vehicle.close()
    return times


def spot_turn_ratio(robot: Robot, yaw_rate_radps: float, rate_hz: int) -> float:
    """True yaw rate over the belts' when turning on the spot; mean over 2 s after 2 s of running in."""
    vehicle = Vehicle(robot, load_world("flat"), PhysicsSettings(physics_rate_hz=rate_hz))
    left, right = track_targets(Twist2(0.0, yaw_rate_radps), robot.tracks)
    for _ in range(2 * rate_hz):
        vehicle.step(left, right)
    true_turn = belt_turn = 0.0
    for _ in range(2 * rate_hz):
        vehicle.step(left, right)
        state = vehicle.state
        true_turn += state.angular_velocity_radps[2]
        belt_turn += (state.belt_speed_mps[1] - state.belt_speed_mps[0]) / robot.tracks.gauge_m
    vehicle.close()
    return float(true_turn / belt_turn)


def cross_step(robot: Robot, suspension: str, rate_hz: int) -> Shake:
    """Drive straight over the step of the packaged world."""
    world = load_world("step")
    step = next(solid for solid in world.solids() if solid.name == "step")
    vehicle = Vehicle(robot, world, PhysicsSettings(physics_rate_hz=rate_hz, suspension=suspension))
    for _ in range(rate_hz):
        vehicle.step(0.0, 0.0)
    heights, places = [0.0], [0.0]
    for _ in range(round(CROSSING_SECONDS * rate_hz)):
        vehicle.step(CROSSING_SPEED_MPS, CROSSING_SPEED_MPS)
        state = vehicle.state
        heights.append(float(state.velocity_mps[2]))
        places.append(float(state.position_m[0]))
    vehicle.close()
    acceleration = low_pass(np.diff(heights) * rate_hz, rate_hz, CUTOFF_HZ)
    first = step.position_m[0] - 0.5 * step.size_m[0] - BEFORE_STEP_M
    last = step.position_m[0] + 0.5 * step.size_m[0] + BEHIND_STEP_M
    place = np.array(places[1:])
    if place[-1] < last:
        raise RuntimeError(f"{suspension} at {rate_hz} Hz got no farther than {place[-1]:.2f} m")
    within = acceleration[(place > first) & (place < last)]
    return Shake(peak(within), root_mean_square(within))


def softened(robot: Robot, load_ratio: float) -> Robot:
    """The robot with springs on which its weight is ``load_ratio`` of the load at which a unit snaps through."""
    present = unit_load_n(robot) / x_structure_of(robot).peak_load_n
    spring = robot.suspension.spring_npm * present / load_ratio
    return robot.model_copy(update={"suspension": robot.suspension.model_copy(update={"spring_npm": spring})})


def change_percent(value: float, reference: float) -> float:
    """Distance of a value from a reference, in percent of the reference."""
    return 100.0 * abs(value / reference - 1.0)


def measure_cost(robot: Robot, quick: bool) -> dict[str, float]:
    """Cost of a step by world."""
    values = {}
    for world in ("flat",) if quick else ("flat", "step", "slats", "rooms"):
        times = step_times_us(robot, world, QUICK_SECONDS if quick else SECONDS)
        median, tail = np.percentile(times, (50, 99)).tolist()
        print(f"step on {world:<8} {median:7.1f} us median {tail:7.1f} us p99")
        prefix = "physics" if world == "flat" else f"physics.{world}"
        values.update({f"{prefix}.step_us_median": median, f"{prefix}.step_us_p99": tail})
    return values


def measure_spot_turn(robot: Robot, quick: bool) -> dict[str, float]:
    """Yaw ratios over yaw rates and physics rates."""
    ratios = {
        yaw_rate: [spot_turn_ratio(robot, yaw_rate, rate) for rate in RATES_HZ]
        for yaw_rate in (QUICK_YAW_RATES if quick else YAW_RATES)
    }
    for yaw_rate, row in ratios.items():
        print(
            f"spot turn {yaw_rate:4.1f} rad/s  "
            + "  ".join(f"{r:.4f} at {hz} Hz" for r, hz in zip(row, RATES_HZ, strict=True))
        )
    spread = max(100.0 * (max(row) / min(row) - 1.0) for row in ratios.values())
    everything = [ratio for row in ratios.values() for ratio in row]
    return {
        "spot_turn.yaw_ratio_min": min(everything),
        "spot_turn.yaw_ratio_max": max(everything),
        "spot_turn.rate_spread_percent": spread,
    }


def measure_step(robot: Robot) -> dict[str, float]:
    """Locked over X structure on the step, at two load ratios, and how far both are from a finer step of time."""
    load = unit_load_n(robot) / x_structure_of(robot).peak_load_n
    cases = {
        "locked": (robot, "locked"),
        "qzs": (robot, "qzs"),
        "qzs_load_065": (softened(robot, SOFT_LOAD_RATIO), "qzs"),
        "linear": (robot, "linear"),
    }
    values, worst_peak, worst_rms = {"step.load_ratio": load}, 0.0, 0.0
    for name, (variant, suspension) in cases.items():
        coarse = cross_step(variant, suspension, CROSSING_RATE_HZ)
        fine = cross_step(variant, suspension, FINE_RATE_HZ)
        worst_peak = max(worst_peak, change_percent(coarse.peak_mps2, fine.peak_mps2))
        worst_rms = max(worst_rms, change_percent(coarse.rms_mps2, fine.rms_mps2))
        values.update({f"step.{name}.peak_mps2": coarse.peak_mps2, f"step.{name}.rms_mps2": coarse.rms_mps2})
        print(
            f"step {name:<13} peak {coarse.peak_mps2:6.2f} ({fine.peak_mps2:6.2f} at {FINE_RATE_HZ} Hz) m/s2   "
            f"rms {coarse.rms_mps2:5.3f} ({fine.rms_mps2:5.3f}) m/s2"
        )
    return values | {
        "step.peak_ratio": values["step.locked.peak_mps2"] / values["step.qzs.peak_mps2"],
        "step.rms_ratio": values["step.locked.rms_mps2"] / values["step.qzs.rms_mps2"],
        "step.rms_ratio_load_065": values["step.locked.rms_mps2"] / values["step.qzs_load_065.rms_mps2"],
        "step.peak_convergence_percent": worst_peak,
        "step.rms_convergence_percent": worst_rms,
    }


def main() -> None:
    """Measure, print a table and write the metrics."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="cost on flat ground and two spot turns only")
    quick = parser.parse_args().quick
    robot = load_robot()
    values = measure_cost(robot, quick) | measure_spot_turn(robot, quick)
    if not quick:
        values |= measure_step(robot)
        for key in (
            "peak_ratio",
            "rms_ratio",
            "rms_ratio_load_065",
            "peak_convergence_percent",
            "rms_convergence_percent",
        ):
            print(f"step.{key:<26} {values[f'step.{key}']:6.2f}")
    if not all(math.isfinite(value) for value in values.values()):
        raise RuntimeError("a figure is not finite")
    print(write_metrics("physics", values))


if __name__ == "__main__":
    main()
