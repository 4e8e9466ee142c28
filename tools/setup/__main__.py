"""``python3 -m tools.setup``: bring the working tree up to date; quick and quiet when it is."""

from __future__ import annotations

import fcntl
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tools.setup.checks import check_machine
from tools.setup.commands import explain
from tools.setup.layout import Layout
from tools.setup.problem import SetupProblem
from tools.setup.steps import setup_steps


def main() -> int:
    """Run what is stale; 0 when the tree is ready, 1 with one sentence when it is not."""
    layout = Layout(Path(__file__).resolve().parents[2])
    try:
        set_up(layout)
    except SetupProblem as problem:
        print(f"set-up: {problem}", file=sys.stderr)
        return 1
    except OSError as error:
        sentence = explain(str(error)) or f"{error}: mend that, then run `make setup` again."
        print(f"set-up: {sentence}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("set-up: interrupted; `make setup` takes it up again.", file=sys.stderr)
        return 130
    return 0


def set_up(layout: Layout) -> None:
    """Every stale step, in order, with one progress line each."""
    steps = setup_steps(layout)
    if all(step.is_current() for step in steps):
        return
    check_machine(layout)
    with only_one(layout):
        begun = time.monotonic()
        for number, step in enumerate(steps, start=1):
            if step.is_current():
                continue
            print(f"[{number}/{len(steps)}] {step.title} ...", flush=True)
            started = time.monotonic()
            step.make()
            print(f"      done in {time.monotonic() - started:.0f} s", flush=True)
        print(f"Set-up complete after {time.monotonic() - begun:.0f} s.", flush=True)


@contextmanager
def only_one(layout: Layout) -> Iterator[None]:
    """Two set-ups of one tree take turns."""
    layout.cache.mkdir(parents=True, exist_ok=True)
    with (layout.cache / "setup.lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            print("Another set-up of this tree is running; waiting for it.", flush=True)
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


if __name__ == "__main__":
    sys.exit(main())
