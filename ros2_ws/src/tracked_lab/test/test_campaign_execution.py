"""Campaigns on real worker processes, with runs that cost nothing."""

import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager

import cloudpickle
import pytest
from distributed import Client

from tracked_lab.campaign.execution import connected, execute, missing
from tracked_lab.campaign.perform import perform
from tracked_lab.campaign.run_inputs import RunInputs
from tracked_lab.campaign.run_store import RunStore
from tracked_lab.campaign.runs_under_way import Plan, SchedulerError
from tracked_report.scenario import Scenario

SCENARIO = {"name": "s", "world": "flat", "duration_s": 1.0, "reference": {"shape": "line"}}
cloudpickle.register_pickle_by_value(sys.modules[__name__])  # workers cannot import a test


def runs(count, first=1):
    scenario = Scenario.model_validate(SCENARIO)
    seeded = [scenario.model_copy(update={"seed": seed}) for seed in range(first, first + count)]
    return [RunInputs(scenario=each, way="double") for each in seeded]


def cheap(inputs):
    return {"true.rms_x_m": 0.001 * inputs.scenario.seed}


def moody(inputs):
    seed = inputs.scenario.seed
    if seed == 2:
        raise RuntimeError("the belt came off")
    while seed == 3:
        time.sleep(0.01)
    return cheap(inputs)


def unhurried(inputs):
    time.sleep(0.1)
    return cheap(inputs)


def blocked(inputs):
    if inputs.scenario.seed == 2:
        time.sleep(3600.0)  # one call: nothing raised in this thread gets through
    return cheap(inputs)


def deadly(inputs):
    if inputs.scenario.seed == 4:
        os.kill(os.getpid(), signal.SIGKILL)
    return cheap(inputs)


@pytest.fixture(scope="module")
def client():
    with connected(None, 2) as made:
        yield made


def done(store, count, client, measure, limit_s=60.0):
    told = []
    execute(Plan("c", missing(runs(count), store), limit_s), store, client, told.append, measure)
    return told


def test_every_run_is_done_once_and_only_what_is_missing_is_done_again(tmp_path, client):
    store = RunStore(tmp_path)
    assert len(done(store, 12, client, cheap)) == 12
    assert {run.seed: run.values["true.rms_x_m"] for run in store.runs().values()}[7] == pytest.approx(0.007)
    assert len(done(store, 16, client, cheap)) == 4
    assert len(store.runs()) == 16


def test_a_run_that_raises_or_hangs_is_recorded_and_stops_nobody(tmp_path, client):
    store = RunStore(tmp_path)
    done(store, 8, client, moody, limit_s=1.0)
    by_seed = {run.seed: run for run in store.runs().values()}
    assert by_seed[2].status == "failed" and "the belt came off" in by_seed[2].error
    assert by_seed[3].status == "timeout" and "1 s" in by_seed[3].error
    assert sum(run.ok for run in by_seed.values()) == 6
    assert missing(runs(8), store) == [] and len(missing(runs(8), store, again=True)) == 2


def test_a_run_stuck_in_one_call_is_recorded_and_its_worker_works_on(tmp_path, client, monkeypatch):
    monkeypatch.setattr("tracked_lab.campaign.runs_under_way._STUCK_GRACE_S", 2.0)
    store, before = RunStore(tmp_path), set(client.run(os.getpid).values())
    done(store, 8, client, blocked, limit_s=0.5)
    by_seed = {run.seed: run for run in store.runs().values()}
    assert by_seed[2].status == "timeout" and "stuck" in by_seed[2].error
    assert sum(run.ok for run in by_seed.values()) == 7
    client.wait_for_workers(2, timeout=60)
    after = set(client.run(os.getpid).values())
    assert len(after) == 2 and len(after & before) == 1


def test_a_run_that_takes_its_worker_down_is_recorded_and_the_others_are_done(tmp_path, client):
    store = RunStore(tmp_path)
    done(store, 8, client, deadly)
    by_seed = {run.seed: run for run in store.runs().values()}
    assert by_seed[4].status == "failed" and "worker" in by_seed[4].error
    assert sum(run.ok for run in by_seed.values()) == 7


def test_a_worker_that_is_killed_costs_nothing(tmp_path, client):
    store, killed = RunStore(tmp_path), []

    def kill_one(_run):
        if not killed:
            killed.append(next(iter(client.run(os.getpid).values())))
            os.kill(killed[0], signal.SIGKILL)

    execute(Plan("c", runs(20), 60.0), store, client, kill_one, cheap)
    assert len(store.runs()) == 20 and all(run.ok for run in store.runs().values())


SCRIPT = """
import sys, time
from pathlib import Path
sys.path[:0] = {path!r}
from tracked_lab.campaign.execution import connected, execute, missing
from tracked_lab.campaign.run_inputs import RunInputs
from tracked_lab.campaign.runs_under_way import Plan
from tracked_lab.campaign.run_store import RunStore

def slow(inputs):
    time.sleep(0.3)
    return {{"true.rms_x_m": 0.001 * inputs.scenario.seed}}

if __name__ == "__main__":
    store = RunStore(Path({folder!r}))
    inputs = [RunInputs.model_validate_json(line) for line in Path({inputs!r}).read_text().splitlines()]
    with connected(None, 2) as client:
        execute(Plan("c", missing(inputs, store), 60.0), store, client, lambda run: print("done", flush=True), slow)
"""


def test_a_client_and_scheduler_that_are_killed_lose_at_most_what_was_in_flight(tmp_path, client):
    wanted, store = runs(24), RunStore(tmp_path / "store")
    (tmp_path / "inputs").write_text("\n".join(run.model_dump_json() for run in wanted))
    script = tmp_path / "campaign_script.py"
    places = {"path": sys.path, "folder": str(store.folder), "inputs": str(tmp_path / "inputs")}
    script.write_text(SCRIPT.format(**places))
    with subprocess.Popen([sys.executable, str(script)], stdout=subprocess.PIPE, text=True) as process:
        for _ in range(14):  # the scheduler lives in the client's process
            assert process.stdout.readline() == "done\n"
        process.send_signal(signal.SIGKILL)
    kept = len(store.runs())
    assert 0 < kept < 24
    execute(Plan("c", missing(wanted, store), 60.0), store, client, lambda _run: None, cheap)
    assert sorted(run.seed for run in store.runs().values()) == list(range(1, 25))


SCHEDULER = """
import sys
sys.path[:0] = {path!r}
from distributed import LocalCluster

if __name__ == "__main__":
    options = dict(threads_per_worker=1, dashboard_address=None, local_directory=sys.argv[1])
    with LocalCluster(n_workers=1, **options) as cluster:
        print(cluster.scheduler_address, flush=True)
        sys.stdin.read()
"""


@contextmanager
def another_scheduler(folder, path):
    script = folder / "scheduler_script.py"
    script.write_text(SCHEDULER.format(path=path))
    command = [sys.executable, str(script), str(folder)]
    plain = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=plain) as process:
        yield process, process.stdout.readline().strip()
        process.stdin.close()


def test_workers_without_this_code_are_one_sentence_and_no_run_is_blamed(tmp_path):
    store = RunStore(tmp_path / "store")
    with (
        another_scheduler(tmp_path, []) as (_, address),
        connected(address, 1) as other,
        pytest.raises(SchedulerError, match="cannot run this code"),
    ):
        execute(Plan("c", runs(3), 60.0), store, other, lambda _run: None, cheap)
    assert not store.runs()


def test_a_scheduler_that_is_killed_is_one_sentence_and_another_one_goes_on(tmp_path, client):
    wanted, store = runs(24), RunStore(tmp_path / "store")
    with another_scheduler(tmp_path, sys.path) as (process, address):
        told = []

        def kill(run):
            told.append(run)
            if len(told) == 5:
                process.send_signal(signal.SIGKILL)
                process.wait()

        with pytest.raises(SchedulerError, match="the scheduler is gone"), connected(address, 1) as other:
            execute(Plan("c", wanted, 60.0), store, other, kill, unhurried)
    assert 5 <= len(store.runs()) < 24 and all(run.ok for run in store.runs().values())
    execute(Plan("c", missing(wanted, store), 60.0), store, client, lambda _run: None, cheap)
    assert sorted(run.seed for run in store.runs().values()) == list(range(1, 25))
    assert all(run.ok for run in store.runs().values())


def test_an_existing_scheduler_is_used(tmp_path, client):
    store = RunStore(tmp_path)
    with connected(client.scheduler.address, 1) as other:
        assert isinstance(other, Client) and other.scheduler.address == client.scheduler.address
        execute(Plan("c", runs(4), 60.0), store, other, lambda _run: None, cheap)
    assert len(store.runs()) == 4


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nonsense://x", "tcp://no.such.host.invalid:1"])
def test_a_scheduler_that_cannot_be_reached_is_one_sentence(address, monkeypatch):
    monkeypatch.setattr("tracked_lab.campaign.execution._CONNECT_S", 0.5)
    with pytest.raises(SchedulerError, match="cannot be reached"), connected(address, 1):
        pass


def test_a_row_tells_where_it_comes_from():
    run = perform(runs(1)[0].model_dump_json(), "c", 10.0, cheap)
    assert run.key == runs(1)[0].key and run.commit and run.created and run.wall_s >= 0.0
