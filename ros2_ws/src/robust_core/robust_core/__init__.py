"""Design and certify state-dependent uncertain systems, with proofs that are checked. Knows no ROS and no robot.

The names below are imported when they are first used, so that plants and certificates cost no solver:

>>> import robust_core
>>> robust_core.Verdict.PROVEN.value
'proven'
"""

from importlib import import_module
from typing import Any

_HOMES = {
    "robust_core.analysis": (
        "Result",
        "certified_region",
        "decide",
        "decide_many",
        "largest_decay",
        "maximised_region",
        "sweep",
    ),
    "robust_core.certificates": ("Certificate", "load_certificate", "save_certificate"),
    "robust_core.errors": ("RobustCoreError",),
    "robust_core.models": ("PolytopicSystem", "RateBounds"),
    "robust_core.theorems": (
        "CommonLyapunov",
        "DStability",
        "ParameterDependent",
        "Relaxed",
        "Slack",
        "TensorCorners",
        "TensorProduct",
    ),
    "robust_core.theorems.regions": ("disc", "half_plane", "intersection", "sector"),
    "robust_core.verdict": ("Verdict",),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}

__all__ = sorted(_HOME_OF)


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOME_OF[name]), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOME_OF])
