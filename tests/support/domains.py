"""A ROS domain for one test, shared with nobody else on the machine."""

import itertools
import os
from contextlib import AbstractContextManager

from tracked_bringup.domains import run_domain

_turn = itertools.count(os.getpid())


def own_domain() -> AbstractContextManager[int]:
    """A domain that nobody holds, whatever ROS_DOMAIN_ID says.

    The next test gets another one, so that no participant on its way out is met.

    Raises
    ------
    NoDomainError: every domain is taken.
    """
    return run_domain(environment={}, skip=next(_turn))
