"""Makes the entries of a page one by one, says how they stand, and writes page and metrics."""

import re
import time
from collections.abc import Callable, Iterable, Sequence

from tracked_lab.gallery.entry import Check, Entry
from tracked_lab.gallery.page import gallery_page
from tracked_report.machine import git_commit
from tracked_report.results import output_folder, write_metrics
from tracked_report.whole_file import write_whole


def publish(
    name: str,
    title: str,
    subtitle: str,
    makers: Iterable[Callable[[], Entry]],
    seed: int,
    facts: Sequence[tuple[str, str]] = (),
) -> int:
    """Write ``<out>/<name>/index.html`` and a metric for every check; the exit code is 1 if one does not hold.

    Metrics: ``<name>.<figures>.<check>`` for every check, and ``<name>.checks`` and ``<name>.failed``.
    """
    entries: list[Entry] = []
    values: dict[str, float] = {}
    for make in makers:
        begun = time.thread_time()
        entry = make()
        entries.append(entry)
        print(f"{'ok' if entry.passed else 'FAILED':7} {entry.figures:16} {entry.label.value:15} "
              f"{entry.headline} ({time.thread_time() - begun:.1f} s)", flush=True)  # fmt: skip
        values |= {f"{name}.{_key(entry.slug)}.{_key(check.what)}": check.value for check in entry.checks}
        for check in _failed(entry):
            print(f"        {check.what}: {check.shown}, must be {check.wanted}")
    failed = sum(len(_failed(entry)) for entry in entries)
    values |= {f"{name}.checks": float(sum(len(entry.checks) for entry in entries)), f"{name}.failed": float(failed)}
    page = output_folder() / name / "index.html"
    page.parent.mkdir(parents=True, exist_ok=True)
    write_whole(page, gallery_page(entries, title, subtitle, [("commit", git_commit()), *facts]))
    print(write_metrics(name, values, seed=seed))
    print(page)
    return 1 if failed else 0


def _failed(entry: Entry) -> list[Check]:
    return [check for check in entry.checks if not check.passed]


def _key(text: str) -> str:
    return re.sub(r"[^a-z0-9]+", "_", text.lower().replace("γ", "gamma")).strip("_")
