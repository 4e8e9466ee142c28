"""Tracks that turn under a robot that does not move: dug in, held or blocked."""

from dataclasses import dataclass

from tracked_localization.witness.settings import WitnessSettings
from tracked_types import Grip, seconds_between

_TURN_WINDOW_S = 0.3
_STILL_TURN = 0.2  # of what the belts ask
_MOVES_AGAIN = 0.5
_IMU_WORD_S = 2.0  # how long an accelerometer's word that the robot stands is good for


@dataclass(frozen=True, slots=True)
class Evidence:
    """What is known at one instant.

    belt_mps, belt_radps: what the belts ask for. felt_mps: forward speed by the accelerometer, None if unknown.
    turned_rad, asked_rad: turn of the gyro and of the belts over the window of a turn; None if unknown. lost_by_scan:
    share of the belts' travel that the ground took in the latest scan interval, None if the scan does not show it.
    turn_by_scan: share of the belts' turn that the latest scan saw, None likewise.
    """

    stamp_ns: int
    belt_mps: float
    belt_radps: float
    felt_mps: float | None
    turned_rad: float | None
    asked_rad: float | None
    lost_by_scan: float | None
    turn_by_scan: float | None


class TractionJudge:
    """Judges the evidence at each instant; belts alone never accuse.

    The scan has the last word on motion ahead. Where it does not see, the accelerometer may accuse, for as long as it
    is good for; a body that has been still for it longer than that is one that nobody sees.
    """

    TURN_WINDOW_S = _TURN_WINDOW_S

    def __init__(self, settings: WitnessSettings) -> None:
        self._settings = settings
        self.clear()

    def clear(self) -> None:
        """Forget everything."""
        self._still_since_ns: int | None = None
        self.ahead = self.turning = False
        self.witness = ""

    @property
    def grip(self) -> Grip:
        """The judgement."""
        return self._grip

    _grip = Grip.UNKNOWN

    def update(self, evidence: Evidence) -> Grip:
        """Judge; see `witness` for whose word it is."""
        settings = self._settings
        rolling = abs(evidence.belt_mps) > settings.least_belt_speed_mps
        spinning = abs(evidence.belt_radps) > settings.least_belt_yaw_rate_radps
        ahead = self._blocked_ahead(evidence) if rolling else ""
        turning = self._blocked_turning(evidence) if spinning else ""
        if not rolling:
            self._still_since_ns = None
        self.ahead, self.turning = bool(ahead), bool(turning)
        self.witness = ahead or turning
        if self.witness:
            self._grip = Grip.BLOCKED
        else:
            self._grip = Grip.HOLDS if rolling or spinning else Grip.UNKNOWN
        return self._grip

    def _blocked_ahead(self, evidence: Evidence) -> str:
        settings = self._settings
        limit = 1.0 - settings.blocked_share
        share_felt = None if evidence.felt_mps is None else evidence.felt_mps / evidence.belt_mps
        still = share_felt is not None and share_felt < (limit if not self.ahead else _MOVES_AGAIN)
        if not still:
            self._still_since_ns = None
        elif self._still_since_ns is None:
            self._still_since_ns = evidence.stamp_ns
        if evidence.lost_by_scan is not None:
            lost_at_least = settings.blocked_share if not self.ahead else 1.0 - _MOVES_AGAIN
            return "scan" if evidence.lost_by_scan > lost_at_least else ""
        if self._still_since_ns is None:
            return ""
        still_s = seconds_between(evidence.stamp_ns, self._still_since_ns)
        return "imu" if settings.blocked_s <= still_s <= _IMU_WORD_S else ""

    def _blocked_turning(self, evidence: Evidence) -> str:
        if evidence.turned_rad is None or evidence.asked_rad is None:
            return ""
        if abs(evidence.asked_rad) < self._settings.least_belt_yaw_rate_radps * _TURN_WINDOW_S:
            return ""
        if evidence.turned_rad / evidence.asked_rad > _STILL_TURN:
            return ""
        if evidence.turn_by_scan is not None and evidence.turn_by_scan > _MOVES_AGAIN:
            return ""  # a gyro that says nothing
        return "imu" if evidence.turn_by_scan is None else "imu and scan"
