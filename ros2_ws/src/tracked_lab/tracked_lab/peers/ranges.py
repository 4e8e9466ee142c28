"""What of each peer is searched, within which ranges, and where the search starts."""

from collections.abc import Mapping

from tracked_lab.peers.constant_multiplier import MultiplierSettings
from tracked_lab.peers.mppi import MppiSettings
from tracked_lab.peers.pursuit import PursuitSettings, RegulatedSettings
from tracked_types.setting import settings_of

Ranges = Mapping[str, tuple[float, float]]

PEER_RANGES: Mapping[str, Ranges] = {
    "pure_pursuit": {"lookahead_s": (0.2, 2.0), "speed_gain": (0.2, 2.0), "turn_gain": (0.5, 5.0)},
    "regulated_pure_pursuit": {
        "lookahead_time_s": (0.4, 3.0),
        "min_lookahead_m": (0.1, 0.6),
        "max_lookahead_m": (0.3, 1.5),
        "min_radius_m": (0.1, 1.5),
        "catch_up_per_s": (0.1, 4.0),
    },
    "mppi": {
        "speed_deviation_mps": (0.05, 0.5),
        "yaw_rate_deviation_radps": (0.1, 2.0),
        "temperature": (0.01, 3.0),
        "gamma": (1e-4, 0.1),
        "path_align": (1.0, 200.0),
        "path_follow": (0.5, 100.0),
        "path_angle": (0.2, 50.0),
    },
    "constant_multiplier": {"factor": (0.9, 1.8)},
}
"""Opti and do-mpc have the weights of the layer that they stand for."""

_SETTINGS = {
    "pure_pursuit": PursuitSettings,
    "regulated_pure_pursuit": RegulatedSettings,
    "mppi": MppiSettings,
    "constant_multiplier": MultiplierSettings,
}


def start_of(name: str) -> dict[str, float]:
    """The defaults of what is searched."""
    defaults = {declared.name: declared.default for declared in settings_of(_SETTINGS[name])}
    return {parameter: float(defaults[parameter]) for parameter in PEER_RANGES[name]}
