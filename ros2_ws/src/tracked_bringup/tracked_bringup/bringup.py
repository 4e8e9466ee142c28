"""``bringup SCENARIO [key:=value ...]``: runs every variant of a scenario in a graph of its own, then reports."""

import os
import shutil
import signal
import sys
import time
from pathlib import Path
from types import FrameType

from ament_index_python.packages import get_package_prefix

from tracked_bringup.command_line import Options, parser, split_options
from tracked_bringup.console import Console
from tracked_bringup.domains import NoDomainError, run_domain
from tracked_bringup.graph_plan import plan_graph
from tracked_bringup.live_state import LiveState
from tracked_bringup.node_table import NodeTable, Value, load_node_table
from tracked_bringup.run_meta import run_meta
from tracked_bringup.scenarios import ArgumentError, load_scenario
from tracked_bringup.supervisor import GraphFailedError, StopRequest, Supervisor, child_environment
from tracked_bringup.variant_run import ExitCode, RunEndedError, RunSettings, VariantRun
from tracked_report.publish import publish_runs
from tracked_report.results import output_folder
from tracked_report.run_record import RunRecord, RunRecordError
from tracked_report.scenario import Scenario
from tracked_report.whole_file import write_whole
from tracked_types.checked_yaml import CheckedFileError


class Bringup:
    """Runs the variants of one scenario one after the other."""

    def __init__(self, scenario: Scenario, table: NodeTable, options: Options, console: Console) -> None:
        self.stop = StopRequest()
        self._scenario = scenario
        self._table = table
        self._options = options
        self._console = console
        self._name = options.name or scenario.name
        self._folder = output_folder() / self._name
        self._records: dict[str, Path] = {}

    def run(self) -> ExitCode:
        """Everything; what went wrong is said on the console."""
        for index, variant in enumerate(self._options.variants or tuple(self._scenario.variants)):
            try:
                with run_domain(skip=index) as domain:
                    self._run_variant(variant, domain)
            except NoDomainError as error:
                self._console.say(str(error), "red")
                return ExitCode.NOT_MATCHED
            except RunEndedError as error:
                self._console.say(f"{variant}: {error}", "red")
                self._console.say(f"logs: {self._logs(variant)}")
                return error.code
        return self._report()

    def _logs(self, variant: str) -> Path:
        return self._folder / "logs" / variant

    def _run_variant(self, variant: str, domain: int) -> None:
        # Here, so that --help and errors in arguments do not wait for rclpy.
        from tracked_bringup.graph_monitor import GraphMonitor

        scenario, options, logs = self._scenario, self._options, self._logs(variant)
        record = self._folder / f"{variant}.npz"
        shutil.rmtree(logs, ignore_errors=True)
        record.unlink(missing_ok=True)
        extra: dict[str, dict[str, Value]] = {
            "recorder": {"record_file": str(record), "meta_file": str(logs / "meta.json")}
        }
        map_stem = self._folder / Path(scenario.world).stem
        saved_map = self._folder / f"{map_stem.name}.yaml"
        if "save_to" not in scenario.parameters_of(variant).get("mapper", {}):
            extra["mapper"] = {"save_to": str(map_stem)}
            saved_map.unlink(missing_ok=True)
        if "folder" not in scenario.parameters_of(variant).get("mcap_recorder", {}):
            bag = self._folder / f"{variant}_bag"
            shutil.rmtree(bag, ignore_errors=True)
            extra["mcap_recorder"] = {"folder": str(bag)}
        plan = plan_graph(
            self._table,
            scenario,
            variant,
            grouping=options.grouping,
            namespace=options.namespace,
            extra=extra,
        )
        meta = run_meta(scenario, variant, simulated=plan.has("sim_bridge"))
        write_whole(logs / "meta.json", meta.model_dump_json(indent=2))
        supervisor = Supervisor(
            plan,
            locate=locate_executable,
            logs=logs,
            environment=child_environment(domain, logs),
            say=self._console.say,
            verbose=options.verbose,
        )
        settings = RunSettings(
            label=variant,
            duration_s=scenario.duration_s,
            open_ended=not scenario.drives or scenario.waits_for_goals(variant),
            stop_at_goal=not scenario.waits_for_goals(variant),
            faults=scenario.faults,
        )
        started_s = time.monotonic()
        monitor = GraphMonitor(plan, domain)
        try:
            state = VariantRun(plan, supervisor, monitor, settings, self._console, self.stop).run()
        finally:
            monitor.close()
        seconds = time.monotonic() - started_s
        self._console.say(f"{variant}: {_outcome(state)}, in {seconds:.0f} s (ROS domain {domain})")
        if plan.has("mapper") and "mapper" in extra:
            self._console.say(f"map:     {saved_map}" if saved_map.exists() else f"no map was saved; logs: {logs}")
        if plan.has("recorder"):
            self._records[variant] = record

    def _report(self) -> ExitCode:
        if not self._records or not self._scenario.drives:
            return ExitCode.DONE
        self._console.status("writing the report")
        try:
            runs = {variant: RunRecord.load(path) for variant, path in self._records.items()}
            baseline = self._scenario.baseline_name
            published = publish_runs(self._name, runs, baseline=baseline if baseline in runs else None)
        except (RunRecordError, OSError, ValueError) as error:
            self._console.status("")
            self._console.say(f"no report: {error}", "red")
            return ExitCode.NO_REPORT
        self._console.status("")
        self._console.say(published.summary)
        self._console.say(f"report:  {published.report}")
        self._console.say(f"metrics: {published.metrics}")
        return ExitCode.DONE


def locate_executable(package: str, executable: str) -> str:
    """Path of an installed executable, as ``ros2 run`` finds it.

    Raises
    ------
    GraphFailedError: if the package or the executable is not installed.
    """
    try:
        path = Path(get_package_prefix(package)) / "lib" / package / executable
    except (LookupError, OSError) as error:
        raise GraphFailedError(f"package {package} is not installed; run `make setup`") from error
    if not os.access(path, os.X_OK):
        raise GraphFailedError(f"package {package} has no executable {executable}; run `make setup`")
    return str(path)


def _outcome(state: LiveState) -> str:
    if state.goal is None:
        return f"{state.time_s:.1f} s simulated"
    error_mm = 1000.0 * state.goal.position_error_m
    return f"goal reached at {state.goal.stamp_ns * 1e-9:.1f} s, {error_mm:.0f} mm off by its odometry"


def main() -> int:
    """Run the bringup; the exit code of the process."""
    arguments = parser().parse_intermixed_args()
    console = Console(sys.stdout)
    try:
        options, changes = split_options(arguments)
        table = load_node_table(arguments.nodes)
        scenario = load_scenario(arguments.scenario, changes, table)
        unknown = [name for name in options.variants if name not in scenario.variants]
        if unknown:
            raise ArgumentError(f"no variant {unknown[0]!r}; there are {', '.join(scenario.variants)}")
    except (ArgumentError, CheckedFileError) as error:
        print(f"bringup: {error}", file=sys.stderr)
        return ExitCode.BAD_ARGUMENTS
    bringup = Bringup(scenario, table, options, console)

    def on_signal(_number: int, _frame: FrameType | None) -> None:
        bringup.stop.set()

    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, on_signal)
    try:
        return bringup.run()
    except (OSError, CheckedFileError) as error:
        print(f"bringup: {error}", file=sys.stderr)
        return ExitCode.NODE_FAILED


if __name__ == "__main__":
    sys.exit(main())
