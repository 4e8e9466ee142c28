"""What was run, what came out, and whether it is as good as claimed. Knows no ROS.

Kept light on purpose: plots and templates are imported by the modules that need them.
"""

from tracked_report.channel import Channel
from tracked_report.results import write_metrics
from tracked_report.run_record import Event, RunMeta, RunRecord
from tracked_report.scenario import Scenario, load_scenario

__all__ = ["Channel", "Event", "RunMeta", "RunRecord", "Scenario", "load_scenario", "write_metrics"]
