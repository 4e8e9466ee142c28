"""How the ground of the kinematic plant answers to the belts."""

from dataclasses import dataclass

import numpy as np
from numpy.random import SeedSequence
from numpy.typing import NDArray

_STREAM = 0x67726F75  # keeps the ground's draws apart from those that others make from the same seed
OBSTACLE_S = (1.6, 2.2)
"""When the obstacle acts, counted from the instant at which the reference begins to move (5.3.2)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ground:
    """The ground of one run.

    belt_lag_s: time constant of the belts. yaw_loss: belt yaw rate over ground yaw rate, less one, on wide turns,
    and yaw_loss_on_spot in addition on tight ones. yaw_terrain, speed_terrain: standard deviations of the slow
    variation of both losses. speed_loss: longitudinal slip straight ahead, and speed_loss_in_turns in addition per
    yaw rate (s/rad). skid_m: sideways speed per yaw rate, outwards. kick_radps, kick_loss, kick_s: yaw rate forced
    by an obstacle, the share of the speed it takes, and from when to when (s).
    """

    belt_lag_s: float
    yaw_loss: float
    yaw_loss_on_spot: float
    yaw_terrain: float
    speed_loss: float
    speed_loss_in_turns: float
    speed_terrain: float
    skid_m: float
    kick_radps: float
    kick_loss: float
    kick_s: tuple[float, float]

    @classmethod
    def of_seed(cls, seed: int, severity: float = 1.0, obstacle: bool = False, begin_s: float = 0.0) -> "Ground":
        """The ground that a seed draws, under any conditions with the same draws.

        ``severity`` scales all slip, 0 is a ground without any; ``begin_s`` is when the reference begins to move.
        """
        generator = np.random.default_rng(SeedSequence([seed, _STREAM]))
        lag, loss, on_spot, speed, skid, kick, kick_loss, side = generator.random(8).tolist()
        return cls(
            belt_lag_s=_between(0.06, 0.10, lag),
            yaw_loss=severity * _between(0.10, 0.20, loss),
            yaw_loss_on_spot=severity * _between(0.25, 0.45, on_spot),
            yaw_terrain=0.06 * severity,
            speed_loss=severity * _between(0.02, 0.06, speed),
            speed_loss_in_turns=severity * 0.05 / 1.3,
            speed_terrain=0.02 * severity,
            skid_m=severity * _between(0.0, 0.04, skid),
            kick_radps=(_between(0.55, 0.95, kick) if side < 0.5 else -_between(0.55, 0.95, kick)) * obstacle,
            kick_loss=_between(0.15, 0.35, kick_loss) * obstacle,
            kick_s=(begin_s + OBSTACLE_S[0], begin_s + OBSTACLE_S[1]),
        )

    def as_array(self) -> NDArray[np.float64]:
        """The fields in their order, the window last as two numbers (12,): what `kinematic_motion` takes."""
        return np.array(
            [
                self.belt_lag_s,
                self.yaw_loss,
                self.yaw_loss_on_spot,
                self.yaw_terrain,
                self.speed_loss,
                self.speed_loss_in_turns,
                self.speed_terrain,
                self.skid_m,
                self.kick_radps,
                self.kick_loss,
                *self.kick_s,
            ]
        )


def _between(low: float, high: float, share: float) -> float:
    return low + (high - low) * share
