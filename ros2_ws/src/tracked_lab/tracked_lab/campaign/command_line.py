"""``campaign``: run, look at, report on and repeat campaigns of simulated runs."""

import argparse
import os
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from tracked_lab.campaign.campaign_report import publish_campaign
from tracked_lab.campaign.progress_line import ProgressLine
from tracked_lab.campaign.results import CampaignResults, gather
from tracked_lab.campaign.run_inputs import RunInputs, UnknownWayError
from tracked_lab.campaign.run_store import RunStore, StoreError
from tracked_lab.campaign.spec import CampaignSpec, load_spec
from tracked_report.metrics import run_metrics
from tracked_report.publish import publish_runs
from tracked_report.results import output_folder
from tracked_report.terminal import render_table
from tracked_types.checked_yaml import CheckedFileError

_QUICK_SEEDS = 3
_TIMES = ("solver.", "loop.", "latency.")  # figures of the clock, not of the run


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; exit code 0, 1 if runs have no figures, 2 if something cannot be done, 130 if interrupted."""
    options = _parser().parse_args(arguments)
    try:
        return int(options.command(options))
    except (CheckedFileError, StoreError, UnknownWayError, ValueError) as error:
        print(f"campaign: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("\ncampaign: interrupted; what is done is kept, the same command goes on from there", file=sys.stderr)
        return 130


def run_campaign(
    spec: CampaignSpec, store: RunStore, *, scheduler: str | None, workers: int, again: bool = False
) -> CampaignResults:
    """Do what is missing and gather the results."""
    # distributed takes a second to import: only who runs something waits for it.
    from tracked_lab.campaign.execution import connected, execute, missing
    from tracked_lab.campaign.runs_under_way import Plan, SchedulerError

    planned = spec.runs()
    plan = Plan(spec.name, missing(planned, store, again=again), spec.time_limit_s)
    line = ProgressLine(len(planned), len(planned) - len(plan.inputs))
    if plan.inputs:
        try:
            with connected(scheduler, workers) as client:
                execute(plan, store, client, line.tell)
        except SchedulerError as error:
            raise ValueError(str(error)) from error
        finally:
            line.end()
    return gather(spec, store.runs())


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="campaign", description=__doc__)
    commands = parser.add_subparsers(required=True)
    for name, command, words in (
        ("run", _run, "run what the store does not have yet, and report"),
        ("status", _status, "how much of it the store has"),
        ("report", _report, "write report.html, runs.csv and metrics.json from the store"),
        ("rerun", _rerun, "repeat one run by its key, check it against the store, and draw it"),
    ):
        sub = commands.add_parser(name, help=words, description=words)
        sub.set_defaults(command=command)
        sub.add_argument("campaign", help="name of a packaged campaign, or a campaign file")
        sub.add_argument("--store", type=Path, help="folder of results (default: out/campaigns/NAME)")
        if name == "run":
            sub.add_argument("--scheduler", help="address of a dask scheduler, such as tcp://host:8786")
            sub.add_argument("--workers", type=_positive, default=os.cpu_count() or 1, help="local worker processes")
            sub.add_argument("--seeds", type=_positive, help="only so many of the seeds")
            sub.add_argument("--main-cell", action="store_true", help="only the cell that matters most")
            sub.add_argument("--quick", action="store_true", help="only the main cell on 3 seeds, into out/NAME_quick")
            sub.add_argument("--again", action="store_true", help="also repeat runs that failed before")
        if name == "rerun":
            sub.add_argument("key", help="key of the run, or its beginning (see runs.csv)")
    return parser


def _positive(text: str) -> int:
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"must be at least 1, got {value}")
    return value


def _opened(options: argparse.Namespace) -> tuple[CampaignSpec, RunStore]:
    spec = load_spec(options.campaign)
    return spec, RunStore(options.store or output_folder() / "campaigns" / spec.name)


def _run(options: argparse.Namespace) -> int:
    spec, store = _opened(options)
    part = spec
    if options.quick or options.seeds:
        count = options.seeds or min(_QUICK_SEEDS, spec.seeds.count)
        part = part.model_copy(update={"seeds": spec.seeds.model_copy(update={"count": count})})
    if options.quick or options.main_cell:
        part = part.main_part()
    if part != spec:
        seeds, cells = spec.seeds.count - part.seeds.count, len(spec.cells()) - len(part.cells())
        print(f"left out: {max(seeds, 0)} of {spec.seeds.count} seeds, {cells} of {len(spec.cells())} cells")
    results = run_campaign(part, store, scheduler=options.scheduler, workers=options.workers, again=options.again)
    return _tell(results, f"{spec.name}_quick" if options.quick else spec.name)


def _report(options: argparse.Namespace) -> int:
    spec, store = _opened(options)
    return _tell(gather(spec, store.runs()), spec.name)


def _tell(results: CampaignResults, name: str) -> int:
    metrics, page = publish_campaign(results, name)
    main, baseline = results.main, results.spec.baseline_name
    names = ("true.rms_x_m", "true.rms_y_m", "true.rms_theta_rad")
    rows = []
    for way in results.spec.ways:
        row = [way]
        for name in names:
            middle, lower = main.median(way, name), main.reduction(way, name, baseline)
            text = "-" if middle is None else f"{1e3 * middle.median:.1f}"
            row.append(text if lower is None or way == baseline else f"{text} ({-lower.median:+.0f} %)")
        rows.append(row)
    print(f"\n{main.label}, true frame, medians over {main.whole_seeds} of {len(main.seeds)} seeds")
    headers = ("", "RMS x (mm)", "RMS y (mm)", "RMS heading (mrad)")
    print(render_table(rows, headers, ("left", "right", "right", "right")))
    print(f"{len(results.runs)} of {results.planned} runs, {results.filled}")
    for run in results.failed[:5]:
        print(f"{run.status}: {run.way}, seed {run.seed}, key {run.key}: {run.error.strip().splitlines()[-1]}")
    print(f"\n{metrics}\n{page}")
    return 1 if results.failed else 0


def _status(options: argparse.Namespace) -> int:
    spec, store = _opened(options)
    stored, planned = store.runs(), [run.key for run in spec.runs()]
    count = Counter(stored[key].status if key in stored else "missing" for key in planned)
    print(", ".join(f"{number} {status}" for status, number in sorted(count.items())))
    if count["ok"]:
        print(gather(spec, stored).filled)
    return 0


def _rerun(options: argparse.Namespace) -> int:
    spec, store = _opened(options)
    found = [run for key, run in store.runs().items() if key.startswith(options.key)]
    if len(found) != 1:
        raise ValueError(f"{len(found)} runs of the store have a key that begins with {options.key!r}; one is needed")
    stored = found[0]
    inputs = RunInputs.model_validate_json(stored.inputs)
    record = inputs.record()
    values = run_metrics(record).values
    same = [name for name in stored.values if not name.startswith(_TIMES)]
    different = [name for name in same if values.get(name) != stored.values[name]]
    published = publish_runs(f"{spec.name}_{stored.key}", {stored.way: record})
    print(published.summary)
    print(published.report)
    if stored.ok and different:
        print(f"campaign: figures differ from the store's: {', '.join(different[:5])}", file=sys.stderr)
        return 1
    print(f"{len(same)} figures are those of the store, bit for bit" if stored.ok else "the store had no figures of it")
    return 0


if __name__ == "__main__":
    sys.exit(main())
