"""What a record says of its run besides the channels."""

from collections.abc import Iterable

from tracked_description import load_robot
from tracked_report.describe_run import describe_run
from tracked_report.run_record import RunMeta
from tracked_report.scenario import Scenario
from tracked_types import Outline


def run_meta(scenario: Scenario, variant: str, *, simulated: bool) -> RunMeta:
    """Everything known before the run; the recorder adds what only the run can tell.

    Raises
    ------
    KeyError: for an unknown variant.
    CheckedFileError: if the robot file or, where it is ``simulated``, the world cannot be used.
    """
    return describe_run(scenario, variant, load_robot(scenario.robot), _scene(scenario.world) if simulated else ())


def _scene(world: str) -> Iterable[Outline]:
    # Here, because a robot does not have the simulator's package.
    from sim_bridge.floor_plan import floor_plan
    from sim_bridge.world import load_world

    return floor_plan(load_world(world))
