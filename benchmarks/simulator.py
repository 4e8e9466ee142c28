"""Real-time factor of the simulator in one process, unpaced, with lidar and IMU, among the walls of the rooms."""

import argparse
import time

import numpy as np

from sim_bridge.simulator import Simulator, SimulatorSettings
from sim_bridge.world import load_world
from tracked_description import load_robot
from tracked_report.results import write_metrics
from tracked_types import PeriodGrid, Twist2, VelocityCommand

SEED = 0
WORLDS = ("rooms", "flat", "step", "slats")
MAIN_WORLD = "rooms"
SECONDS, QUICK_SECONDS = 20, 4
"""Simulated time in each world."""


def drive(simulator: Simulator, seconds: int) -> tuple[list[float], list[float]]:
    """Wall and processor time (s) of every simulated second of a gentle S-curve."""
    control = PeriodGrid(simulator.robot.control.rate_hz)
    wall, processor = [], []
    for second in range(seconds):
        turn = 0.4 if second % 4 < 2 else -0.4
        wall_start, processor_start = time.perf_counter(), time.thread_time()
        for _ in range(simulator.robot.imu.rate_hz):
            simulator.advance()
            if control.is_instant(simulator.stamp_ns):
                simulator.submit(VelocityCommand(simulator.stamp_ns, Twist2(0.2, turn)))
        wall.append(time.perf_counter() - wall_start)
        processor.append(time.thread_time() - processor_start)
    return wall, processor


def main() -> None:
    """Measure, print a table and write the metrics."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help=f"only the world {MAIN_WORLD}, and shorter")
    quick = parser.parse_args().quick
    worlds, seconds = ((MAIN_WORLD,), QUICK_SECONDS) if quick else (WORLDS, SECONDS)
    robot = load_robot()
    values: dict[str, float] = {}
    print(f"{'world':<10}{'real-time factor':>18}{'slowest second':>16}{'processor ms per s':>20}")
    for name in worlds:
        simulator = Simulator(robot, load_world(name), SimulatorSettings(lidar_mode="rolling"), seed=SEED)
        simulator.advance()  # compiled code is loaded by the first step
        wall, processor = drive(simulator, seconds)
        simulator.close()
        factor, slowest = 1.0 / float(np.median(wall)), 1.0 / max(wall)
        cost_ms = 1e3 * float(np.median(processor))
        print(f"{name:<10}{factor:>18.1f}{slowest:>16.1f}{cost_ms:>20.1f}")
        values[f"simulator.{name}.real_time_factor"] = factor
        values[f"simulator.{name}.processor_ms_per_s"] = cost_ms
    values["simulator.real_time_factor"] = values[f"simulator.{MAIN_WORLD}.real_time_factor"]
    print(write_metrics("simulator", values, seed=SEED))


if __name__ == "__main__":
    main()
