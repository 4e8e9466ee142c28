"""Makes the report anew from saved records: ``python -m tracked_report.render out/demo/*.npz --name demo``."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from tracked_report.publish import publish_runs
from tracked_report.run_record import RunRecord, RunRecordError
from tracked_report.synthetic import synthetic_pair


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line; exit code 1 where a record cannot be read or nothing can be written."""
    parser = argparse.ArgumentParser(prog="render", description="Make report.html and metrics.json from saved runs.")
    parser.add_argument("records", nargs="*", type=Path, help="records (.npz); none: made-up ones")
    parser.add_argument("--name", default="sample", help="folder under the output folder (default sample)")
    parser.add_argument("--baseline", help="variant the others are compared with (default the first)")
    parser.add_argument("--out", type=Path, help="output folder (default out)")
    options = parser.parse_args(arguments)
    try:
        runs = {(record := RunRecord.load(path)).meta.variant: record for path in options.records} or synthetic_pair()
        published = publish_runs(options.name, runs, baseline=options.baseline, out=options.out)
    except (RunRecordError, ValueError, OSError) as error:
        print(f"render: {error}", file=sys.stderr)
        return 1
    print(f"{published.summary}\n\n{published.report}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
