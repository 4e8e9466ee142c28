"""visualization_msgs/MarkerArray of movers: a disc each, and an arrow to where it will be in a second."""

from collections.abc import Sequence

from geometry_msgs.msg import Point
from visualization_msgs.msg import Marker, MarkerArray

from node_kit.conversions.headers import fill_header
from tracked_types import Mover

_HEIGHT_M = 0.1
_ARROW_M = (0.04, 0.1, 0.1)  # shaft, head, length of the head
_LIFETIME_NS = 500_000_000


def movers_to_message(movers: Sequence[Mover]) -> MarkerArray:
    """Markers in the namespaces ``mover`` and ``course``, with the mover's identity; they vanish by themselves."""
    message = MarkerArray()
    for mover in movers:
        disc, course = _marker(mover, "mover", Marker.CYLINDER), _marker(mover, "course", Marker.ARROW)
        x, y = mover.position_m.tolist()
        disc.pose.position.x, disc.pose.position.y, disc.pose.position.z = x, y, 0.5 * _HEIGHT_M
        disc.scale.x = disc.scale.y = 2.0 * float(mover.radius_m)
        disc.scale.z = _HEIGHT_M
        ahead_x, ahead_y = mover.position_at(1.0).tolist()
        course.points = [Point(x=x, y=y, z=_HEIGHT_M), Point(x=ahead_x, y=ahead_y, z=_HEIGHT_M)]
        course.scale.x, course.scale.y, course.scale.z = _ARROW_M
        message.markers += [disc, course]
    return message


def _marker(mover: Mover, namespace: str, kind: int) -> Marker:
    marker = Marker(ns=namespace, id=int(mover.identity), type=kind, action=Marker.ADD)
    fill_header(marker.header, mover.stamp_ns, mover.frame_id)
    marker.pose.orientation.w = 1.0
    marker.color.r, marker.color.g, marker.color.a = 1.0, 0.5, 0.8
    marker.lifetime.nanosec = _LIFETIME_NS
    return marker
