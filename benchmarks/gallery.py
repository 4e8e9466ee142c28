"""The figures of chapters 2 and 3 made anew: out/gallery/index.html, and a metric for every check.

Exit code 1 if a check does not hold.
"""

import argparse
import re
import sys
import time

from tracked_lab.gallery import ENTRIES
from tracked_lab.gallery.page import gallery_page
from tracked_report.machine import git_commit
from tracked_report.results import output_folder, write_metrics
from tracked_report.whole_file import write_whole

SEED = 35


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="smaller maps and coarser simulations, in seconds")
    quick = parser.parse_args().quick
    entries, values = [], {}
    for make in ENTRIES:
        begun = time.thread_time()
        entry = make(quick)
        entries.append(entry)
        print(f"{'ok' if entry.passed else 'FAILED':7} {entry.figures:16} {entry.label.value:15} "
              f"{entry.headline} ({time.thread_time() - begun:.1f} s)", flush=True)  # fmt: skip
        for check in entry.checks:
            key = re.sub(r"_+", "_", re.sub(r"[^a-z0-9]+", "_", check.what.lower().replace("γ", "gamma"))).strip("_")
            values[f"gallery.{re.sub('[^a-z0-9]+', '_', entry.slug)}.{key}"] = check.value
            if not check.passed:
                print(f"        {check.what}: {check.shown}, must be {check.wanted}")
    checks = [check.passed for entry in entries for check in entry.checks]
    values |= {"gallery.checks": float(len(checks)), "gallery.failed": float(len(checks) - sum(checks))}
    page = output_folder() / "gallery" / "index.html"
    page.parent.mkdir(parents=True, exist_ok=True)
    write_whole(page, gallery_page(entries, git_commit()))
    print(write_metrics("gallery", values, seed=SEED))
    print(page)
    return 0 if all(checks) else 1


if __name__ == "__main__":
    sys.exit(main())
