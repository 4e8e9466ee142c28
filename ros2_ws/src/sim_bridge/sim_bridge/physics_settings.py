"""How the physics is computed."""

from dataclasses import dataclass

from sim_bridge.belts.parameters import LAWS
from tracked_description import Robot
from tracked_description.suspension import SuspensionKind
from tracked_types.setting import check_settings, setting

AS_DESCRIBED = "robot"


@dataclass(frozen=True, slots=True, kw_only=True)
class PhysicsSettings:
    """Step rate and suspension law of a simulated vehicle."""

    physics_rate_hz: int = setting(480, "physics steps per second", unit="Hz", low=120, high=8000)
    suspension: str = setting(
        AS_DESCRIBED, "suspension law; robot takes that of the robot file", choices=(AS_DESCRIBED, *LAWS)
    )

    def __post_init__(self) -> None:
        check_settings(self)

    def suspension_kind(self, robot: Robot) -> SuspensionKind:
        """The law that these settings mean for one robot."""
        for kind in LAWS:
            if self.suspension == kind:
                return kind
        return robot.suspension.kind
