"""Search the weights of every way to drive of Table 5.1 with the same budget; write them with the log of the search.

Runs on the kinematic plant with 0.1 s of pipeline latency, a lidar pose, and the sudden change of pose in every other
run, on seeds from 1000 on, which no reported figure uses.
"""

import argparse
import json
import tempfile
from dataclasses import asdict
from pathlib import Path

import numpy as np
from distributed import Client, LocalCluster

from tracked_lab.table_variants import TABLE_VARIANTS, packaged_weights
from tracked_lab.weight_search import SEEDS, proposals, score, write_weights


def searched(name: str, budget: int, client: Client, folder: Path, log: list[str]) -> tuple[dict[str, object], float]:
    """The best weights by role, and their score; every trial is a line of the log."""
    way, generator = TABLE_VARIANTS[name], np.random.default_rng(0)
    best: tuple[dict[str, object], float] = ({}, float("inf"))
    file = folder / f"{name}.yaml"
    for number, proposal in enumerate(proposals(way, budget, generator)):
        write_weights(proposal.roles, file)
        scores = client.gather(client.map(lambda seed: score(way, file, seed), SEEDS, pure=False))
        proposal.score = float(np.mean(scores))
        weights = {role: asdict(value) for role, value in proposal.roles.items()}
        log.append(
            json.dumps({"variant": name, "trial": number, "score": round(proposal.score, 4), "weights": weights})
        )
        if proposal.score < best[1]:
            best = (dict(proposal.roles), proposal.score)
        print(f"{name}: trial {number + 1} of {budget} scores {proposal.score:.3f}, best {best[1]:.3f}", flush=True)
    return best


def main() -> None:
    """Search and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=60, help="for each way to drive")
    parser.add_argument("--only", nargs="*", choices=TABLE_VARIANTS, default=list(TABLE_VARIANTS))
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--quick", action="store_true", help="two trials each, nothing is written")
    arguments = parser.parse_args()
    budget = 2 if arguments.quick else arguments.trials
    with (
        tempfile.TemporaryDirectory() as folder,
        LocalCluster(n_workers=arguments.workers, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        for name in arguments.only:
            log: list[str] = []
            roles, reached = searched(name, budget, client, Path(folder), log)
            if arguments.quick:
                continue
            comment = (
                f"# {TABLE_VARIANTS[name].description}: best of {budget} trials by `make tune`, score {reached:.3f}.\n"
                "# Weights that it does not use are the packaged ones. search_log.jsonl holds every trial.\n"
            )
            target = packaged_weights(name)
            write_weights(roles, target, comment)  # type: ignore[arg-type]
            history = target.parent / "search_log.jsonl"
            kept = history.read_text().splitlines() if history.exists() else []
            kept = [line for line in kept if json.loads(line)["variant"] != name]
            history.write_text("\n".join([*kept, *log]) + "\n")


if __name__ == "__main__":
    main()
