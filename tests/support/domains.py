"""A ROS domain for one test, shared with nobody else on the machine."""

import fcntl
import itertools
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

# Above 101 the ports of a domain reach into the range from which Linux gives out ephemeral ports.
DOMAINS = range(1, 102)
_turn = itertools.count(os.getpid())


@contextmanager
def own_domain() -> Iterator[int]:
    """Hold a domain by a lock that ends with the process, whatever way it ends.

    Yields:
        A domain id; the next test gets another one, so that no participant on its way out is met.

    Raises:
        RuntimeError: every domain is taken.
    """
    directory = Path(tempfile.gettempdir()) / "tracked_stack_domains"
    directory.mkdir(exist_ok=True)
    for _ in DOMAINS:
        domain = DOMAINS[next(_turn) % len(DOMAINS)]
        with (directory / f"{domain}.lock").open("w") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            yield domain
            return
    raise RuntimeError(f"all ROS domains are in use by other tests, see {directory}")
