"""Compiles everything that the simulator compiles, so that later starts are quick: ``python -m sim_bridge.warm_up``."""

import sys
import time

from sim_bridge.compiled import cache_directory
from sim_bridge.physics_settings import PhysicsSettings
from sim_bridge.vehicle import Vehicle
from sim_bridge.world import load_world
from tracked_description import load_robot


def main() -> int:
    """Step a vehicle on two worlds; what it compiles lands in the cache."""
    began = time.perf_counter()
    robot = load_robot()
    for name in ("flat", "step"):
        vehicle = Vehicle(robot, load_world(name), PhysicsSettings())
        vehicle.step(0.1, 0.1)
        vehicle.close()
    print(f"simulator compiled in {time.perf_counter() - began:.1f} s, kept in {cache_directory()}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
