"""Topics of any type, whose messages nobody decodes: their classes, and which quality of service fits."""

from collections.abc import Iterable, Sequence
from importlib import import_module
from typing import Any

from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime

_NANO = 10**9


class UnknownTypeError(LookupError):
    """A message type is not installed here; the text names it."""


def message_class(type_name: str) -> Any:
    """The class of ``package/msg/Name``.

    Raises
    ------
    UnknownTypeError: there is none here.
    """
    package, _, name = type_name.partition("/msg/")
    try:
        return getattr(import_module(f"{package}.msg"), name)
    except (ImportError, AttributeError, ValueError) as error:
        raise UnknownTypeError(f"type {type_name} is not installed here") from error


def matching_profile(writers: Iterable[QoSProfile], depth: int) -> QoSProfile:
    """What hears all of these writers and loses as little as they let it."""
    profiles = list(writers)
    reliable = all(profile.reliability is ReliabilityPolicy.RELIABLE for profile in profiles)
    latched = all(profile.durability is DurabilityPolicy.TRANSIENT_LOCAL for profile in profiles)
    return QoSProfile(
        depth=depth,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )


def hears(reader: QoSProfile, wanted: QoSProfile) -> bool:
    """Whether a reader asks for no more than what fits all writers now.

    It may ask for less than it could where the worst writer has left: a new subscription would only repeat what is
    latched.
    """
    return (reader.reliability == wanted.reliability or reader.reliability == ReliabilityPolicy.BEST_EFFORT) and (
        reader.durability == wanted.durability or reader.durability == DurabilityPolicy.VOLATILE
    )


def playing_profile(*, latched: bool, depth: int) -> QoSProfile:
    """For playing a topic: reliable, which every reader hears."""
    return QoSProfile(
        depth=depth,
        reliability=ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )


def offered(writers: Sequence[Any]) -> list[Qos]:
    """Quality of service of a topic's publishers, given by their endpoints, as a recording states it."""
    return [_as_recorded(endpoint.qos_profile) for endpoint in writers]


def hash_of(endpoints: Sequence[Any]) -> str:
    """Hash of the type that these endpoints speak; empty where the middleware does not say."""
    texts = [str(endpoint.topic_type_hash) for endpoint in endpoints]
    return next((text for text in texts if text.startswith("RIHS01_")), "")


def _as_recorded(profile: QoSProfile) -> Qos:
    return Qos(
        history=QosHistory(int(profile.history)),
        depth=profile.depth,
        reliability=QosReliability(int(profile.reliability)),
        durability=QosDurability(int(profile.durability)),
        deadline=_time(profile.deadline),
        lifespan=_time(profile.lifespan),
        liveliness=QosLiveliness(int(profile.liveliness)),
        liveliness_lease_duration=_time(profile.liveliness_lease_duration),
        avoid_ros_namespace_conventions=bool(profile.avoid_ros_namespace_conventions),
    )


def _time(duration: Any) -> QosTime:
    return QosTime(*divmod(duration.nanoseconds, _NANO))
