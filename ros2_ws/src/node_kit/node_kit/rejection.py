"""Why a message is refused, and the count of refusals."""

from collections import Counter
from dataclasses import dataclass, field


class RejectedMessage(ValueError):
    """A message cannot be used; ``reason`` says why in a few words, such as ``not finite: linear.x``."""

    def __init__(self, reason: str) -> None:
        super().__init__(reason)
        self.reason = reason


MOST_REASONS = 50  # distinct ones kept per topic; hostile input must not fill the memory


@dataclass(slots=True)
class RejectionLedger:
    """Accepted and rejected messages of one topic, by reason and sender."""

    topic: str
    accepted: int = 0
    rejected: Counter[tuple[str, str]] = field(default_factory=Counter)
    newest_reason: str = ""
    newest_sender: str = ""

    def reject(self, reason: str, sender: str) -> int:
        """Count one rejection; returns how often this reason and sender have met."""
        self.newest_reason, self.newest_sender = reason, sender
        key = (reason, sender)
        if key not in self.rejected and len(self.rejected) >= MOST_REASONS:
            key = ("other reasons", "any sender")
        self.rejected[key] += 1
        return self.rejected[key]

    def as_values(self) -> dict[str, str]:
        """Key-value pairs for diagnostics."""
        values = {f"{self.topic}: accepted": str(self.accepted)}
        for (reason, sender), count in sorted(self.rejected.items()):
            values[f"{self.topic}: {reason} (from {sender})"] = str(count)
        return values
