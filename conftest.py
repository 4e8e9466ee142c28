"""Property tests draw the same examples in every run, without deadlines: the load of machines differs."""

from hypothesis import settings

settings.register_profile("tracked_stack", deadline=None, derandomize=True)
settings.load_profile("tracked_stack")
