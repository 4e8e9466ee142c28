"""sensor_msgs/JointState of a track pair."""

from array import array
from collections.abc import Sequence

from sensor_msgs.msg import JointState

from node_kit.conversions.checks import require_finite, require_size
from node_kit.conversions.headers import fill_header, stamp_from_message
from node_kit.rejection import RejectedMessage
from tracked_types import LEFT_TRACK, RIGHT_TRACK, TrackSample


def tracks_from_message(message: JointState, *, wheel_radius_m: float) -> TrackSample:
    """Belt travel and speed of the joints left_track and right_track; other joints are ignored.

    Without velocities, which drivers may leave out, the speeds are None.

    Raises
    ------
    RejectedMessage: a joint is missing or named twice, an array has the wrong size, or a number is not finite.
    """
    stamp_ns = stamp_from_message(message.header.stamp)
    names, position, velocity = message.name, message.position, message.velocity
    require_size("position", position, len(names))
    left, right = _index(names, LEFT_TRACK), _index(names, RIGHT_TRACK)
    travels = (
        require_finite("position of left_track", position[left] * wheel_radius_m),
        require_finite("position of right_track", position[right] * wheel_radius_m),
    )
    if not len(velocity):
        return TrackSample(stamp_ns, *travels)
    require_size("velocity", velocity, len(names))
    return TrackSample(
        stamp_ns,
        *travels,
        require_finite("velocity of left_track", velocity[left] * wheel_radius_m),
        require_finite("velocity of right_track", velocity[right] * wheel_radius_m),
    )


def tracks_to_message(
    sample: TrackSample,
    suspension_travel_m: Sequence[float] = (),
    into: JointState | None = None,
    *,
    wheel_radius_m: float,
    suspension_joints: Sequence[str] = (),
) -> JointState:
    """Message of both tracks and, after them, of the suspension joints with their travel (m, speed unknown: 0).

    Without both speeds it has no velocities.

    Raises
    ------
    ValueError: the number of travels is not that of the joints.
    """
    if len(suspension_travel_m) != len(suspension_joints):
        raise ValueError(f"{len(suspension_travel_m)} travels for {len(suspension_joints)} suspension joints")
    message = JointState() if into is None else into
    fill_header(message.header, sample.stamp_ns, "")
    message.name = [LEFT_TRACK, RIGHT_TRACK, *suspension_joints]
    travels = [sample.left_travel_m / wheel_radius_m, sample.right_travel_m / wheel_radius_m]
    message.position = array("d", [*travels, *suspension_travel_m])
    left, right = sample.left_speed_mps, sample.right_speed_mps
    speeds = [] if left is None or right is None else [left / wheel_radius_m, right / wheel_radius_m]
    message.velocity = array("d", speeds + [0.0] * len(suspension_joints) if speeds else [])
    return message


def _index(names: list[str], name: str) -> int:
    occurrences = names.count(name)
    if occurrences != 1:
        raise RejectedMessage(f"joint {name} occurs {occurrences} times")
    return names.index(name)
