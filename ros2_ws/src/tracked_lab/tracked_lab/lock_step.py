"""Plant and stack in lock-step: one deterministic thread of events, no clock but simulated time."""

from collections.abc import Callable

from sim_bridge.floor_plan import floor_plan
from sim_bridge.world import load_world
from tracked_description import Robot, load_robot
from tracked_lab.closed_loop import ClosedLoop
from tracked_lab.conditions import Conditions
from tracked_lab.kinematic_ground import OBSTACLE_S
from tracked_lab.lidar_pose import LidarPose
from tracked_lab.links import LinkScheduler
from tracked_lab.plants import make_plant, reference_begins_s
from tracked_lab.stack import Stack
from tracked_lab.steering_registry import steering_of_run
from tracked_report.describe_run import describe_run
from tracked_report.node_parameters import node_parameters
from tracked_report.run_record import RunRecord
from tracked_report.scenario import Scenario
from tracked_types import seconds_between

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
    lidar_pose = LidarPose(robot, scenario.seed, plant.start) if conditions.pose == "lidar" else None
    oracle_slip = conditions.slip_source == "oracle"
    loop = ClosedLoop(plant, stack, links, lidar_pose=lidar_pose, oracle_slip=oracle_slip)
    try:
        end_s = scenario.duration_s
        while (now_s := seconds_between(plant.stamp_ns, 0)) < end_s:
            loop.tick()
            if progress is not None:
                progress(now_s)
    finally:
        plant.close()
    meta = describe_run(scenario, variant, robot, floor_plan(load_world(scenario.world)))
    start = plant.start
    begin_s = reference_begins_s(robot, parameters)
    known = {
        "time": "lock_step",
        "odom_in_world": (start.x_m, start.y_m, start.yaw_rad),
        "disturbed_s": tuple(begin_s + after_s for after_s in OBSTACLE_S) if conditions.obstacle else None,
        "notes": {"conditions": conditions.model_dump_json(exclude_defaults=True)},
    }
    return loop.recorder.record(meta.model_copy(update=known))
