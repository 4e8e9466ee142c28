"""Where the robot is and how its tracks slip."""

from tracked_localization.estimate import Estimate
from tracked_localization.health import Culprit, Fault, Health
from tracked_localization.innovation import Innovation
from tracked_localization.odometry_filter import OdometryFilter
from tracked_localization.settings import OdometryFilterSettings
from tracked_localization.slip import SlipEstimator, SlipSettings, track_slip

__all__ = [
    "Culprit",
    "Estimate",
    "Fault",
    "Health",
    "Innovation",
    "OdometryFilter",
    "OdometryFilterSettings",
    "SlipEstimator",
    "SlipSettings",
    "track_slip",
]
