"""Figures 5.10 and 5.17 to 5.24 made anew from runs of the belt world: out/figures_5/index.html, a metric per check.

Exit code 1 if a check does not hold.
"""

import argparse
import sys
from functools import partial

from tracked_bringup.node_table import load_node_table
from tracked_bringup.scenarios import load_scenario
from tracked_lab.figures import ENTRIES, drive_figure_runs
from tracked_lab.gallery.publish import publish

TITLE = "Chapter 5, driving, figure by figure"
SUBTITLE = (
    "The figures of the thesis on slip and tracking, made anew in simulation by the objects that the nodes wrap. Each "
    "entry is an executable check on one run; Table 5.1 has the medians over many."
)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="the same: everything is made in seconds")
    parser.parse_args()
    scenario = load_scenario("compare", [], load_node_table())
    runs = drive_figure_runs(scenario)
    facts = [
        ("scenario", "that of the demo (compare)"),
        ("seed", str(scenario.seed)),
        ("upper pipeline latency", f"{scenario.pipeline_latency_s:g} s"),
        ("localisation", "odometry and IMU"),
    ]
    return publish("figures_5", TITLE, SUBTITLE, [partial(make, runs) for make in ENTRIES], scenario.seed, facts)


if __name__ == "__main__":
    sys.exit(main())
