"""The plant that a run's conditions ask for."""

from tracked_description import Robot
from tracked_lab.conditions import Conditions
from tracked_lab.plant import Plant
from tracked_lab.tuning import NodeParameters
from tracked_report.scenario import Scenario


def make_plant(scenario: Scenario, robot: Robot, parameters: NodeParameters, conditions: Conditions) -> Plant:
    """The plant of one run, on the ground that its seed and its conditions give it.

    Raises
    ------
    UnknownParameterError, CheckedFileError, ValueError: if scenario or conditions ask for what does not exist.
    """
    if conditions.plant == "kinematic":
        raise ValueError("the kinematic plant is not composed yet")
    # The physics engine is loaded by those alone who need it.
    from tracked_lab.belt_world import BeltWorld

    return BeltWorld(robot, parameters.get("sim_bridge", {}), scenario.faults, conditions)
