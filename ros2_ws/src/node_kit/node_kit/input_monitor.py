"""Health of a node's inputs: what was rejected lately, of whom and why. No ROS."""

from node_kit.diagnostics import Level
from node_kit.rejection import RejectionLedger


class InputMonitor:
    """Sums up the ledgers of all subscriptions of a node.

    memory_s: how long a rejection keeps the level at WARN.
    """

    def __init__(self, memory_s: float) -> None:
        self._memory_s = memory_s
        self._ledgers: list[RejectionLedger] = []
        self._rejected_s: dict[str, float] = {}

    def add(self, topic: str) -> RejectionLedger:
        """A ledger for one more subscription."""
        ledger = RejectionLedger(topic)
        self._ledgers.append(ledger)
        return ledger

    def note_rejection(self, topic: str, now_s: float) -> bool:
        """Remember when ``topic`` was last rejected; true if nothing else was rejected lately."""
        was_healthy = not self._recent(now_s)
        self._rejected_s[topic] = now_s
        return was_healthy

    def summary(self, now_s: float) -> tuple[Level, str, dict[str, str]]:
        """Level, message and values for diagnostics."""
        values: dict[str, str] = {}
        for ledger in self._ledgers:
            values.update(ledger.as_values())
        recent = self._recent(now_s)
        if not recent:
            return Level.OK, "all inputs are accepted", values
        offences = [
            f"{ledger.topic} ({ledger.newest_reason}, from {ledger.newest_sender})"
            for ledger in self._ledgers
            if ledger.topic in recent
        ]
        return Level.WARN, f"rejected: {', '.join(offences)}", values

    def _recent(self, now_s: float) -> set[str]:
        return {topic for topic, at_s in self._rejected_s.items() if now_s - at_s < self._memory_s}
