"""What the lab adds to a scenario: plant, ground, sensors, links, and who steers."""

from typing import Annotated, Literal

from pydantic import Field

from tracked_types.checked_yaml import CheckedModel

Seconds = Annotated[float, Field(ge=0.0, le=10.0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
LinkName = Literal["imu", "tracks", "pose", "estimate", "reference", "plan", "command"]
NMPC = "nmpc"


class Link(CheckedModel):
    """One way that data take between two parts of the stack.

    latency_s: least time under way. jitter_s: further time under way, uniform between zero and this, drawn anew
    for each message, so that messages may overtake each other. loss: share of messages that never arrive.
    """

    latency_s: Seconds = 0.0
    jitter_s: Seconds = 0.0
    loss: Annotated[float, Field(ge=0.0, le=1.0, allow_inf_nan=False)] = 0.0

    @property
    def ideal(self) -> bool:
        """Whether everything arrives at once."""
        return self.latency_s == 0.0 and self.jitter_s == 0.0 and self.loss == 0.0


class Links(CheckedModel):
    """Every link of the stack, ideal unless said otherwise; at equal times they deliver in this order.

    imu, tracks, pose: sensors to the odometry filter. estimate: odometry and slip to whoever steers. reference:
    trajectory player to whoever steers. plan: upper to lower layer. command: arbiter to the base, which applies a
    command a transport delay after its stamp, so that only what comes later than that is felt.
    """

    imu: Link = Link()
    tracks: Link = Link()
    pose: Link = Link()
    estimate: Link = Link()
    reference: Link = Link()
    plan: Link = Link()
    command: Link = Link()


class Conditions(CheckedModel):
    """Under which conditions the lab runs a scenario; the default is what the graph does.

    plant: the simulator's belts on its ground, or the fast kinematic plant.
    varied_ground: belts only, the seed also draws the friction and where in the world the robot starts; the
        kinematic plant always draws its ground.
    pose: odometry alone, or also a pose from a lidar (10 Hz, 80 ms late, 1 cm and 6 mrad; made from the truth).
    slip_severity: scales the ground's slip, 1 as it is; 0 is no slip on the kinematic plant, and is refused by belts.
    obstacle: the robot is turned by force between 1.6 and 2.2 s after the reference has begun to move.
    slip_source: what compensates slip gets the estimate, or the truth.
    steering: the NMPC layers, or another way to steer by its name; steering_parameters are its own.
    """

    plant: Literal["belts", "kinematic"] = "belts"
    varied_ground: bool = False
    pose: Literal["odometry", "lidar"] = "odometry"
    slip_severity: NotNegative = 1.0
    obstacle: bool = False
    links: Links = Links()
    slip_source: Literal["estimated", "oracle"] = "estimated"
    steering: Annotated[str, Field(min_length=1)] = NMPC
    steering_parameters: dict[str, float | int | str | bool] = Field(default_factory=dict)
