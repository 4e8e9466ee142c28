"""What every test run has in common."""

import signal

from hypothesis import settings

# Property tests draw the same examples in every run, without deadlines: the load of machines differs.
settings.register_profile("tracked_stack", deadline=None, derandomize=True)
settings.load_profile("tracked_stack")

# A shell starts background jobs with SIGINT ignored, and children inherit that: processes under test would not hear it.
signal.signal(signal.SIGINT, signal.default_int_handler)
