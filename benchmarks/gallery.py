"""The figures of chapters 2 and 3 made anew: out/gallery/index.html, and a metric for every check.

Exit code 1 if a check does not hold.
"""

import argparse
import sys
from functools import partial

from tracked_lab.gallery.publish import publish
from tracked_lab.gallery.theory import ENTRIES

SEED = 35
TITLE = "Chapters 2 and 3, figure by figure"
SUBTITLE = (
    "Every figure of the thesis on stability, stabilisation and filtering, made anew by robust_core. Each entry is an "
    "executable check; what is called proven was decided in exact arithmetic."
)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="smaller maps and coarser simulations, in seconds")
    quick = parser.parse_args().quick
    return publish("gallery", TITLE, SUBTITLE, [partial(make, quick) for make in ENTRIES], SEED)


if __name__ == "__main__":
    sys.exit(main())
