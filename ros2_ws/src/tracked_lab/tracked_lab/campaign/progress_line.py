"""How far a campaign is, on one line."""

import sys
import time

from tracked_lab.campaign.run_store import StoredRun


class ProgressLine:
    """Done, failed and left on one line of a terminal; without one, a line now and then."""

    def __init__(self, total: int, done: int) -> None:
        self._total, self._done, self._failed, self._fresh = total, done, 0, 0
        self._began_s = self._shown_s = time.monotonic()
        self._live = sys.stdout.isatty()
        print(f"{total} runs, {done} of them done before", flush=True)

    def tell(self, run: StoredRun) -> None:
        """One more run has ended."""
        self._done += 1
        self._fresh += 1
        self._failed += not run.ok
        now_s = time.monotonic()
        if now_s - self._shown_s < (0.2 if self._live else 15.0) and self._done < self._total:
            return
        self._shown_s = now_s
        rate = self._fresh / max(now_s - self._began_s, 1e-9)
        left_s = (self._total - self._done) / rate
        share = round(30 * self._done / self._total)
        text = f"[{'#' * share}{'.' * (30 - share)}] {self._done}/{self._total}, {rate:.1f}/s, {left_s:.0f} s left"
        text += f", {self._failed} without figures" if self._failed else ""
        print(f"\r\x1b[K{text}" if self._live else text, end="" if self._live else "\n", flush=True)

    def end(self) -> None:
        """Leave the line."""
        if self._live:
            print()
