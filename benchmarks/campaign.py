"""How fast campaigns are: runs per second, cost per run from 100 to 10 000 runs, two workers against one, belts.

Runs per second and the gain of a second worker come from real ten-second runs of the double layer with a lidar pose on
the kinematic plant; what a campaign adds to each run comes from runs that do nothing. The belt world's pace is its
simulated time over the processor time of its worker. On the way a worker is killed, and every run must be there once.
"""

import argparse
import os
import signal
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from distributed import Client

from tracked_lab.campaign.execution import connected, execute
from tracked_lab.campaign.perform import Measure
from tracked_lab.campaign.run_inputs import RunInputs
from tracked_lab.campaign.run_store import RunStore, StoredRun
from tracked_lab.campaign.runs_under_way import Plan
from tracked_lab.conditions import Conditions
from tracked_report.results import write_metrics
from tracked_report.scenario import Reference, Scenario

DURATION_S = 10.0
KINEMATIC = Conditions(plant="kinematic", pose="lidar", obstacle=True)


def inputs(count: int, first: int, conditions: Conditions) -> list[RunInputs]:
    """Runs of the double layer on consecutive seeds."""
    scenario = Scenario(
        name="speed", world="flat", duration_s=DURATION_S, reference=Reference(shape="s_curve"), pipeline_latency_s=0.1
    )
    seeded = [scenario.model_copy(update={"seed": seed}) for seed in range(first, first + count)]
    return [RunInputs(scenario=each, way="double", conditions=conditions) for each in seeded]


def nothing(_inputs: RunInputs) -> Mapping[str, float]:
    """A run that costs nothing."""
    return {"true.rms_x_m": 0.0}


def timed(
    runs: Sequence[RunInputs], client: Client, measure: Measure = RunInputs.figures
) -> tuple[float, list[StoredRun]]:
    """Wall seconds of a campaign into an empty store, and its rows."""
    with tempfile.TemporaryDirectory() as folder:
        store, began = RunStore(Path(folder)), time.monotonic()
        execute(Plan("speed", runs, 120.0), store, client, lambda _run: None, measure)
        return time.monotonic() - began, list(store.runs().values())


def survived(client: Client) -> float:
    """Share of the runs that are there once with figures although a worker was killed in the middle."""
    runs, killed = inputs(40, 9000, KINEMATIC), []
    with tempfile.TemporaryDirectory() as folder:
        store = RunStore(Path(folder))

        def kill_once(_run: StoredRun) -> None:
            if not killed:
                killed.append(next(iter(client.run(os.getpid).values())))
                os.kill(killed[0], signal.SIGKILL)

        execute(Plan("killed", runs, 60.0), store, client, kill_once, nothing)
        return sum(run.ok for run in store.runs().values()) / len(runs)


def main() -> None:
    """Measure and write metrics."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer runs: 1000 instead of 10 000 that do nothing")
    quick = parser.parse_args().quick
    count, many = (16, 1000) if quick else (40, 10_000)
    values: dict[str, float] = {}
    with connected(None, 2) as client:
        timed(inputs(4, 8000, KINEMATIC), client)  # solver code and kernels are loaded
        two_s, rows = timed(inputs(count, 8100, KINEMATIC), client)
        values["kinematic_runs_per_s"] = count / two_s
        values["kinematic_cpu_s"] = float(np.median([row.cpu_s for row in rows]))
        print(
            f"two workers: {values['kinematic_runs_per_s']:.1f} runs/s, {values['kinematic_cpu_s']:.2f} s of CPU each",
            flush=True,
        )
        belts = inputs(2 if quick else 6, 8200, Conditions(plant="belts", pose="lidar", varied_ground=True))
        _, rows = timed(belts, client)
        values["belts_pace_x"] = DURATION_S / float(np.median([row.cpu_s for row in rows]))
        print(f"belt world: {values['belts_pace_x']:.1f} times real time per core", flush=True)
        few_s, _ = timed(inputs(100, 1, KINEMATIC), client, nothing)
        many_s, _ = timed(inputs(many, 1, KINEMATIC), client, nothing)
        values["overhead_100_ms"], values["overhead_many_ms"] = 1e3 * few_s / 100, 1e3 * many_s / many
        added_s = (many_s / many - few_s / 100) + two_s / count
        values["cost_growth_x"] = added_s / (two_s / count)
        print(
            f"a campaign adds {values['overhead_100_ms']:.1f} ms to each of 100 runs, "
            f"{values['overhead_many_ms']:.1f} ms to each of {many}",
            flush=True,
        )
        values["survived_share"] = survived(client)
    with connected(None, 1) as client:
        timed(inputs(2, 8000, KINEMATIC), client)
        one_s, _ = timed(inputs(count // 2, 8100, KINEMATIC), client)
    values["second_worker_x"] = (one_s / (count // 2)) / (two_s / count)
    print(f"a second worker: {values['second_worker_x']:.2f} times as many runs")
    print(write_metrics("campaign_quick" if quick else "campaign", values, seed=8000))


if __name__ == "__main__":
    main()
