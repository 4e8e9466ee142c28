"""How much of robust_core its own tests run, by lines and branches, and how long its files are.

Branches are those of coverage.py: both outcomes of every condition. What only other processes run does not count.
"""

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

from tracked_report.results import write_metrics

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "ros2_ws" / "src" / "robust_core"


def covered() -> dict[str, float]:
    """Shares (%) of branches and lines, and the number of each.

    Raises
    ------
    SystemExit: if coverage is not installed, or a test fails: its branches would count as not run.
    """
    if find_spec("coverage") is None:
        raise SystemExit("coverage is not installed in this environment; `make setup` brings what requirements/ states")
    with tempfile.TemporaryDirectory() as folder:
        data, report = Path(folder) / "data", Path(folder) / "report.json"
        measure = [sys.executable, "-m", "coverage"]
        run = ["run", "--branch", f"--data-file={data}", f"--source={PACKAGE / 'robust_core'}", "-m"]
        tests = ["pytest", "-q", "-p", "no:cacheprovider", str(PACKAGE / "test")]
        if code := subprocess.run([*measure, *run, *tests], cwd=ROOT, check=False).returncode:
            raise SystemExit(f"the tests of robust_core ended with code {code}")
        subprocess.run([*measure, "json", f"--data-file={data}", "-o", str(report), "-q"], cwd=ROOT, check=True)
        totals = json.loads(report.read_text(encoding="utf-8"))["totals"]
    branches, lines = totals["num_branches"], totals["num_statements"]
    return {
        "coverage.branches_percent": 100.0 * totals["covered_branches"] / branches,
        "coverage.lines_percent": 100.0 * totals["covered_lines"] / lines,
        "coverage.branches": float(branches),
        "coverage.lines": float(lines),
    }


def lengths() -> dict[str, float]:
    """Median and largest number of lines of the package's files; empty ones do not count."""
    files = [path.read_text(encoding="utf-8").count("\n") for path in (PACKAGE / "robust_core").rglob("*.py")]
    found = [lines for lines in files if lines]
    return {
        "files.count": float(len(found)),
        "files.median_lines": statistics.median(found),
        "files.longest_lines": float(max(found)),
    }


def main() -> int:
    """Measure, print and write the metrics."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args()
    values = lengths() | covered()
    for key, value in values.items():
        print(f"{key:28}{value:10.5g}")
    print(write_metrics("robust_coverage", values))
    return 0


if __name__ == "__main__":
    sys.exit(main())
