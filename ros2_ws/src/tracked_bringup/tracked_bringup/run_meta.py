"""What a record says of its run besides the channels."""

from tracked_description import load_robot
from tracked_report.describe_run import describe_run
from tracked_report.run_record import CommandLimits, RunMeta
from tracked_report.scenario import Scenario
from tracked_types import Outline


def run_meta(scenario: Scenario, variant: str) -> RunMeta:
    """Everything known before the run; the recorder adds what only the run can tell.

    Raises
    ------
    KeyError: for an unknown variant.
    """
    robot = load_robot(_robot_file(scenario, variant))
    limits = CommandLimits(
        speed_min_mps=robot.limits.speed_min_mps,
        speed_max_mps=robot.limits.speed_max_mps,
        yaw_rate_max_radps=robot.limits.yaw_rate_max_radps,
    )
    scene = _scene(scenario.world)
    return describe_run(scenario, variant, limits=limits, suspension=robot.suspension.kind, scene=scene)


def _scene(world: str) -> tuple[Outline, ...]:
    """The world from above, for the report; empty on a robot, which carries no simulator."""
    try:
        from sim_bridge.floor_plan import floor_plan
        from sim_bridge.world import load_world
    except ImportError:
        return ()
    return floor_plan(load_world(world))


def _robot_file(scenario: Scenario, variant: str) -> str:
    return str(scenario.parameters_of(variant).get("sim_bridge", {}).get("robot_file", ""))
