"""Measures every claim of the ledgers: ``python -m tracked_report.claims [--part P] [--quick] [--jobs N]``.

Exit codes: 0 all claims hold; 1 some claim is missed; 2 a command failed or a figure is not there (its claims
are MISS, with the reason); 3 the ledger itself cannot be read.
"""

import argparse
import json
import math
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tracked_report.ledger import SELF, Claim, Ledger, load_ledgers
from tracked_report.machine import git_commit
from tracked_report.measuring import LOGS, QUICK_OUT, Measured, measure
from tracked_report.progress import Progress
from tracked_report.results import write_metrics
from tracked_report.terminal import coloured, render_table
from tracked_report.whole_file import write_whole
from tracked_types.checked_yaml import CheckedFileError

HOLDS, MISSED, NOT_MEASURED, BAD_LEDGER, INTERRUPTED = 0, 1, 2, 3, 130


@dataclass(frozen=True, slots=True)
class Verdict:
    """One claim, measured. ``value`` is None, with the reason, when there is no figure."""

    claim: Claim
    value: float | None
    reason: str
    commit: str
    command: str

    @property
    def ok(self) -> bool:
        """Whether the claim holds."""
        return self.value is not None and self.claim.holds(self.value)

    def entry(self) -> dict[str, Any]:
        """Its entry in out/claims.json; ``reason`` only where nothing was measured."""
        target = list(self.claim.target) if isinstance(self.claim.target, tuple) else self.claim.target
        entry = {
            "value": self.value,
            "target": target,
            "unit": self.claim.unit,
            "ok": self.ok,
            "commit": self.commit,
            "command": self.command,
        }
        return {**entry, "reason": self.reason} if self.reason else entry


def judge(claim: Claim, measured: Measured) -> Verdict:
    """Hold one claim against what its command measured."""
    value, reason = None, measured.failure
    if not reason:
        if claim.key not in measured.values:
            reason = f"the metrics have no {claim.key}"
        else:
            value = measured.values[claim.key]
            if value is None or not math.isfinite(value):
                value, reason = None, f"{claim.key} is not a finite number"
    return Verdict(claim, value, reason, measured.commit, measured.command)


def measure_all(ledgers: Sequence[Ledger], root: Path, *, quick: bool, jobs: int, progress: Progress) -> list[Verdict]:
    """Run every distinct command once, ``jobs`` at a time, and judge all claims (or the quick ones)."""
    started = time.monotonic()
    claims = [(ledger, claim) for ledger in ledgers for claim in ledger.claims if claim.quick or not quick]
    wanted = {
        f"{ledger.part}_{claim.source}": ledger.measurements[claim.source]
        for ledger, claim in claims
        if claim.source != SELF
    }

    def run(name: str) -> Measured:
        with progress.step(wanted[name].quick if quick else wanted[name].run) as step:
            measured = measure(name, wanted[name], root, quick=quick, tick=progress.show, cancel=cancel)
            step.outcome = measured.failure
            return measured

    cancel = threading.Event()
    with ThreadPoolExecutor(max_workers=max(1, jobs)) as pool:
        try:
            results: dict[str, Measured] = dict(zip(wanted, pool.map(run, wanted), strict=True))
        except KeyboardInterrupt:
            cancel.set()
            raise
    seconds = time.monotonic() - started
    itself = Measured(
        "claims", seconds, {"claims.seconds": seconds, "claims.minutes": seconds / 60.0}, git_commit(root)
    )
    return [
        judge(claim, itself if claim.source == SELF else results[f"{ledger.part}_{claim.source}"])
        for ledger, claim in claims
    ]


def table(verdicts: Sequence[Verdict], words: tuple[str, str]) -> str:
    """One line per claim: id, target, measured, margin, verdict; the reason where nothing was measured."""
    rows = []
    for verdict in verdicts:
        claim = verdict.claim
        word = coloured(words[0], "green") if verdict.ok else coloured(words[1], "red")
        target = f"{claim.target_text()} {claim.unit}".strip()
        if verdict.value is None:
            rows.append([word, claim.id, target, "-", "-", verdict.reason[:80]])
        else:
            rows.append([word, claim.id, target, f"{verdict.value:.4g}", f"{claim.margin(verdict.value):+.3g}", ""])
    headers = ["", "claim", "target", "measured", "margin", ""]
    return render_table(rows, headers, ["left", "left", "right", "right", "right"])


def write_claims(path: Path, verdicts: Sequence[Verdict], known_ids: Mapping[str, Any]) -> Path:
    """Write out/claims.json; entries of claims not measured this time stay, of claims no longer made go."""
    entries: dict[str, Any] = {}
    try:
        earlier = json.loads(path.read_text(encoding="utf-8"))
        entries = {key: entry for key, entry in earlier.items() if key in known_ids}
    except (OSError, ValueError, AttributeError):
        pass
    entries.update({verdict.claim.id: verdict.entry() for verdict in verdicts})
    return write_whole(path, json.dumps(entries, indent=2, sort_keys=True, allow_nan=False) + "\n")


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line of the claims ledger."""
    parser = argparse.ArgumentParser(prog="claims", description="Measure every figure that the project claims.")
    parser.add_argument("--part", help="only the ledger claims/PART.yaml")
    parser.add_argument("--quick", action="store_true", help="only quick claims, by their quick commands, on two cores")
    parser.add_argument("--jobs", type=int, default=None, help="commands at a time (default 1, with --quick 2)")
    parser.add_argument("--root", type=Path, default=Path(), help="folder that holds claims/ and gets out/")
    options = parser.parse_args(arguments)
    root = options.root.resolve()
    try:
        everything = load_ledgers(root / "claims")
        ledgers = load_ledgers(root / "claims", options.part)
    except CheckedFileError as error:
        print(f"claims: {error}", file=sys.stderr)
        return BAD_LEDGER
    jobs = options.jobs if options.jobs is not None else (2 if options.quick else 1)
    started = time.monotonic()
    try:
        verdicts = measure_all(ledgers, root, quick=options.quick, jobs=jobs, progress=Progress(sys.stderr))
    except KeyboardInterrupt:
        print("claims: interrupted, nothing written", file=sys.stderr)
        return INTERRUPTED
    seconds = time.monotonic() - started
    out = root / (QUICK_OUT if options.quick else Path("out"))
    known = {claim.id: claim for ledger in everything for claim in ledger.claims}
    path = write_claims(out / "claims.json", verdicts, known)
    held = sum(verdict.ok for verdict in verdicts)
    figures = {"claims.seconds": seconds, "claims.count": len(verdicts), "claims.missed": len(verdicts) - held}
    write_metrics("claims", figures, out=out)
    print(table(verdicts, ("PASS", "FAIL" if options.quick else "MISS")))
    print(f"{held} of {len(verdicts)} claims hold, measured in {seconds:.0f} s; {path.relative_to(root)}")
    if any(verdict.value is None for verdict in verdicts):
        print(f"what the commands said: {(out / LOGS).relative_to(root)}/")
        return NOT_MEASURED
    return HOLDS if held == len(verdicts) else MISSED


if __name__ == "__main__":
    sys.exit(main())
