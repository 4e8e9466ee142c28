"""The vehicles of the recordings: what differs from robot.yaml, and the settings made from it."""

from importlib import resources
from typing import Any

from pydantic import Field

from tracked_description import Robot, load_robot
from tracked_localization import OdometryFilterSettings, SlipSettings
from tracked_types.checked_yaml import CheckedModel, check_content, load_checked_yaml


class Vehicle(CheckedModel):
    """A recorded vehicle. source: where its recording comes from, and its licence.

    robot: keys that replace those of robot.yaml. filter: values of the odometry filter's tunable fields.
    """

    source: str
    robot: dict[str, Any]
    filter: dict[str, float | int] = Field(default_factory=dict)

    def as_robot(self) -> Robot:
        """robot.yaml with this vehicle's numbers in it.

        Raises
        ------
        CheckedFileError: if a key is unknown or out of range.
        """
        return check_content(Robot, _merged(load_robot().model_dump(), self.robot), "recorded vehicle")

    def slip_settings(self) -> SlipSettings:
        """Settings of the slip object."""
        return SlipSettings.from_robot(self.as_robot())

    def filter_settings(self) -> OdometryFilterSettings:
        """Settings of the odometry filter."""
        tuning: dict[str, Any] = dict(self.filter)
        return OdometryFilterSettings.from_robot(self.as_robot(), **tuning)


def load_vehicle(name: str) -> Vehicle:
    """The packaged vehicle of this name.

    Raises
    ------
    CheckedFileError: if there is none, or its file is malformed.
    """
    file = f"{name}.yaml"
    return load_checked_yaml(Vehicle, resources.files("tracked_lab") / "data" / "recordings" / file, file)


def _merged(base: dict[str, Any], changes: dict[str, Any]) -> dict[str, Any]:
    """``base`` with ``changes`` put in, section by section."""
    merged = dict(base)
    for key, value in changes.items():
        inner = merged.get(key)
        merged[key] = _merged(inner, value) if isinstance(inner, dict) and isinstance(value, dict) else value
    return merged
