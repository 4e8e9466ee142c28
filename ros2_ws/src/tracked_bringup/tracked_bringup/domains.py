"""ROS domains that no other run on this machine uses."""

import fcntl
import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

DOMAINS = range(102)  # above, the ports of a domain reach into those that Linux gives out freely
LOCKS = Path(tempfile.gettempdir()) / "tracked_stack_domains"


class NoDomainError(RuntimeError):
    """There is no domain to run in; the text says why."""


@contextmanager
def run_domain(environment: Mapping[str, str] = os.environ, skip: int = 0, locks: Path = LOCKS) -> Iterator[int]:
    """The domain that ROS_DOMAIN_ID names, or else one that nobody holds, from number ``skip`` on.

    It is held by a lock on a file, which ends with the process whatever way that ends.

    Raises
    ------
    NoDomainError: if ROS_DOMAIN_ID is no domain, or all of them are held.
    """
    asked = environment.get("ROS_DOMAIN_ID", "").strip()
    if asked:
        if not asked.isdigit() or int(asked) > 232:
            raise NoDomainError(f"ROS_DOMAIN_ID must be a number from 0 to 232, got {asked!r}")
        yield int(asked)
        return
    locks.mkdir(exist_ok=True)
    for step in DOMAINS:
        domain = DOMAINS[(skip + step) % len(DOMAINS)]
        with (locks / f"{domain}.lock").open("w") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            yield domain
            return
    raise NoDomainError(f"all ROS domains are in use, see {locks}; set ROS_DOMAIN_ID")
