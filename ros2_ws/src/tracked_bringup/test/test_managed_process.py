import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from tracked_bringup.managed_process import ManagedProcess, end_all

LIMIT_S = 10.0
STUBBORN = (
    "import signal, time\nfor n in (2, 15): signal.signal(n, signal.SIG_IGN)\n"
    "print('ready', flush=True)\ntime.sleep(60)"
)
POLITE = (
    "import time\nprint('ready', flush=True)\ntry: time.sleep(60)\nexcept KeyboardInterrupt: print('bye', flush=True)"
)
PARENT = f"""
import subprocess, sys, time
child = subprocess.Popen([sys.executable, "-c", {STUBBORN!r}], stdout=subprocess.PIPE)
child.stdout.readline()
print("ready", child.pid, flush=True)
time.sleep(60)
"""


def process(tmp_path: Path, code: str, said: list[str] | None = None, verbose: bool = True) -> ManagedProcess:
    say = (said if said is not None else []).append
    return ManagedProcess(
        "child", [sys.executable, "-c", code], dict(os.environ), tmp_path / "logs" / "child.log", say, verbose=verbose
    )


def until(condition: Callable[[], object]) -> None:
    deadline = time.monotonic() + LIMIT_S
    while not condition():
        assert time.monotonic() < deadline
        os.sched_yield()


def is_alive(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except OSError:
        return False
    return state not in ("Z", "X")


def test_output_is_stored_whole_and_shown_with_its_prefix(tmp_path: Path) -> None:
    said: list[str] = []
    child = process(tmp_path, "print('hello'); import sys; print('trouble', file=sys.stderr)", said)
    child.start()
    assert child.wait(LIMIT_S) and child.exit_code == 0
    child.sweep()
    assert sorted((tmp_path / "logs" / "child.log").read_text().splitlines()) == ["hello", "trouble"]
    assert sorted(said) == ["[child] hello", "[child] trouble"]


def test_only_warnings_and_errors_are_shown_unless_asked(tmp_path: Path) -> None:
    said: list[str] = []
    lines = ["[INFO] [1.0] [n]: fine", "[WARN] [1.0] [n]: odd", "[FATAL] [1.0] [n]: bad", "ValueError: no"]
    child = process(tmp_path, f"print({chr(10).join(lines)!r})", said, verbose=False)
    child.start()
    assert child.wait(LIMIT_S)
    child.sweep()
    assert said == [f"[child] {line}" for line in lines[1:]]


def test_last_words_survive_the_process(tmp_path: Path) -> None:
    child = process(tmp_path, "for i in range(100): print(i)\nraise SystemExit(3)")
    child.start()
    assert child.wait(LIMIT_S) and child.exit_code == 3
    assert child.last_words.splitlines()[-1] == "99" and len(child.last_words.splitlines()) == 15


def test_a_polite_child_ends_on_the_first_signal(tmp_path: Path) -> None:
    said: list[str] = []
    child = process(tmp_path, POLITE, said)
    child.start()
    until(lambda: said)
    assert end_all([child]) == []
    assert child.exit_code == 0 and said[-1] == "[child] bye"


def test_a_stubborn_child_is_killed_and_named(tmp_path: Path) -> None:
    said: list[str] = []
    child = process(tmp_path, STUBBORN, said)
    child.start()
    until(lambda: said)
    quick = ((signal.SIGINT, 0.05), (signal.SIGTERM, 0.05), (signal.SIGKILL, LIMIT_S))
    assert end_all([child], quick) == ["child"]
    assert child.exit_code == -signal.SIGKILL


def test_children_of_children_are_ended_too(tmp_path: Path) -> None:
    said: list[str] = []
    child = process(tmp_path, PARENT, said)
    child.start()
    until(lambda: said)
    grandchild = int(said[0].split()[-1])
    end_all([child])
    until(lambda: not is_alive(grandchild))


def test_children_end_when_this_process_is_killed(tmp_path: Path) -> None:
    code = f"""
import os, sys, time
from pathlib import Path
from tracked_bringup.managed_process import ManagedProcess
lines = []
child = ManagedProcess("child", [sys.executable, "-c", {POLITE!r}], dict(os.environ), Path({str(tmp_path)!r}) / "log",
                       lines.append, verbose=True)
child.start()
while not lines:
    os.sched_yield()
print(child.pid, flush=True)
time.sleep(60)
"""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    supervisor = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True, env=environment)
    assert supervisor.stdout is not None
    pid = int(supervisor.stdout.readline())
    assert is_alive(pid)
    supervisor.kill()
    supervisor.wait(LIMIT_S)
    until(lambda: not is_alive(pid))


def test_a_program_that_does_not_exist_is_an_error(tmp_path: Path) -> None:
    child = ManagedProcess("child", ["/no/such/program"], dict(os.environ), tmp_path / "log", lambda _: None)
    with pytest.raises(FileNotFoundError):
        child.start()


def test_a_log_that_cannot_be_written_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "logs").write_text("a file where the folder should be")
    with pytest.raises(OSError):
        process(tmp_path, "pass").start()


def test_it_can_be_started_again_and_appends_to_its_log(tmp_path: Path) -> None:
    child = process(tmp_path, "print('hello')")
    for _ in range(2):
        child.start()
        assert child.wait(LIMIT_S)
        child.sweep()
    assert child.starts == 2
    assert (tmp_path / "logs" / "child.log").read_text() == "hello\nhello\n"
