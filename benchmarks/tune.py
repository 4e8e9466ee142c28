"""Search the weights of every way to drive of Table 5.1, and the parameters of its peers, with the same budget.

Runs on the kinematic plant with 0.1 s of pipeline latency, a lidar pose, and the sudden change of pose in every other
run, on seeds from 1000 on, which no reported figure uses. Results and the log of the search are written into
tracked_lab's data.
"""

import argparse
import json
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import yaml
from distributed import Client, LocalCluster

from tracked_lab.parameter_search import Point, Proposal, Ranges, proposals
from tracked_lab.peers.ranges import PEER_RANGES, start_of
from tracked_lab.peers.tuned import TUNED_FILE
from tracked_lab.table_variants import TABLE_VARIANTS, packaged_weights
from tracked_lab.weight_search import (
    SEEDS,
    packaged_point,
    roles_of,
    score,
    tuning_conditions,
    weight_ranges,
    write_weights,
)
from tracked_report.scenario import Variant

LOG = packaged_weights("none").parent / "search_log.jsonl"


def searched(name: str, start: Point, ranges: Ranges, budget: int, scores: Callable[[Point], list[float]]) -> Proposal:
    """The best proposal; every trial becomes a line of the log."""
    lines, best = [], Proposal({})
    for number, proposal in enumerate(proposals(start, ranges, budget, np.random.default_rng(0))):
        proposal.score = float(np.mean(scores(proposal.point)))
        best = min(best, proposal, key=lambda tried: tried.score)
        trial = {"name": name, "trial": number, "score": round(proposal.score, 4), "point": dict(proposal.point)}
        lines.append(json.dumps(trial))
        print(f"{name}: trial {number + 1} of {budget} scores {proposal.score:.3f}, best {best.score:.3f}", flush=True)
    LOG.parent.mkdir(parents=True, exist_ok=True)
    kept = LOG.read_text().splitlines() if LOG.exists() else []
    kept = [line for line in kept if json.loads(line)["name"] != name]
    LOG.write_text("\n".join([*kept, *lines]) + "\n")
    return best


def search_weights(name: str, budget: int, client: Client, folder: Path) -> None:
    """Weights of one way to drive."""
    way, file = TABLE_VARIANTS[name], folder / f"{name}.yaml"

    def scores(point: Point) -> list[float]:
        write_weights(roles_of(point), file)
        variant = way.with_weights(file)
        conditions = [way.with_weights_in(tuning_conditions(seed), file) for seed in SEEDS]
        found: list[float] = client.gather(client.map(score, [variant] * len(SEEDS), conditions, SEEDS, pure=False))
        return found

    best = searched(name, packaged_point(way), weight_ranges(way), budget, scores)
    comment = (
        f"# {way.description}: best of {budget} trials by `make tune`, score {best.score:.3f}.\n"
        "# Weights that it does not use are the packaged ones. search_log.jsonl holds every trial.\n"
    )
    write_weights(roles_of(best.point), packaged_weights(name), comment)


def search_peer(name: str, budget: int, client: Client) -> None:
    """Parameters of one peer."""

    def scores(point: Point) -> list[float]:
        changed = {"steering": name, "steering_parameters": dict(point)}
        conditions = [tuning_conditions(seed).model_copy(update=changed) for seed in SEEDS]
        found: list[float] = client.gather(client.map(score, [Variant()] * len(SEEDS), conditions, SEEDS, pure=False))
        return found

    best = searched(name, start_of(name), PEER_RANGES[name], budget, scores)
    known = yaml.safe_load(TUNED_FILE.read_text()) if TUNED_FILE.exists() else {}
    known[name] = dict(best.point)
    TUNED_FILE.write_text(
        "# Found by `make tune`; weights/search_log.jsonl holds every trial.\n" + yaml.safe_dump(known)
    )


def main() -> None:
    """Search and write."""
    names = [*TABLE_VARIANTS, *PEER_RANGES]
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=56, help="for each way to drive")
    parser.add_argument("--only", nargs="*", choices=names, default=names)
    parser.add_argument("--workers", type=int, default=2)
    arguments = parser.parse_args()
    with (
        tempfile.TemporaryDirectory() as folder,
        LocalCluster(n_workers=arguments.workers, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        for name in arguments.only:
            if name in TABLE_VARIANTS:
                search_weights(name, arguments.trials, client, Path(folder))
            else:
                search_peer(name, arguments.trials, client)


if __name__ == "__main__":
    main()
