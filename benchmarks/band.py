"""Timed elastic band: time of a replan, against IPOPT on the same problems, and contacts in crowded scenes.

Speed: closed loops at 5 Hz through scenes with three obstacles and a mover (seeds unused in tuning). A replan is the
whole update: association, candidates, descent and checks. Of each band that was pulled tight with all its 24 intervals,
IPOPT solves the problem anew in the same run, in turns with the band's own descent, from the same start and with the
same nearest obstacles. All times are of the thread's processor.
"""

import argparse
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from band_ipopt import IpoptBand
from numpy.typing import NDArray

from tracked_description import load_robot
from tracked_navigation.band import BandSettings, TimedElasticBand
from tracked_navigation.band.band_result import ARRIVED
from tracked_navigation.band.clearance import clearances
from tracked_navigation.band.optimizer import INTERVALS, Association, BandEnd, BandOptimizer, Optimised
from tracked_navigation.band.scenes import (
    PERIOD_S,
    Moment,
    Scene,
    benchmark_scene,
    driven,
    hard_scene,
    random_scene,
)
from tracked_navigation.band.surroundings import Surroundings
from tracked_report.results import write_metrics

Array = NDArray[np.float64]
SEED = 9000
EVERY = 4  # of the recorded problems is solved by both


@dataclass(frozen=True, slots=True)
class Problem:
    """What the descent was asked."""

    nodes: Array
    end: BandEnd
    associate: Association
    iterations: int


class Recorder(BandOptimizer):
    """The band's optimiser, which keeps what it is asked."""

    def __init__(self, settings: BandSettings) -> None:
        super().__init__(settings)
        self.problems: list[Problem] = []

    def optimise(self, nodes: Array, end: BandEnd, associate: Association, iterations: int) -> Optimised:
        """As the band's own would."""
        self.problems.append(Problem(nodes, end, associate, iterations))
        return super().optimise(nodes, end, associate, iterations)


def replan_times(band: TimedElasticBand, runs: int) -> Array:
    """Processor time (ms) of every update."""
    times = [
        1e3 * moment.cpu_s
        for seed in range(SEED, SEED + runs)
        for moment in driven(band, benchmark_scene(seed), seed=seed)
        if moment.result.kind != ARRIVED
    ]
    return np.array(times)


def against_ipopt(settings: BandSettings, runs: int) -> dict[str, float]:
    """Times of both on the same problems."""
    recorder = Recorder(settings)
    band = TimedElasticBand(settings, recorder)
    for seed in range(SEED + 100, SEED + 100 + runs):
        for _ in driven(band, benchmark_scene(seed), seed=seed):
            pass
    problems = [problem for problem in recorder.problems if len(problem.nodes) == INTERVALS + 1][::EVERY]
    own, peer = BandOptimizer(settings), IpoptBand(settings, INTERVALS)
    own_times, ipopt_times, solved = [], [], 0
    for problem in problems:
        began = time.thread_time()
        own.optimise(problem.nodes, problem.end, problem.associate, problem.iterations)
        turned = time.thread_time()
        _, succeeded = peer.solve(problem.nodes, problem.end, problem.associate(problem.nodes[1:]))
        ended = time.thread_time()
        own_times.append(turned - began)
        ipopt_times.append(ended - turned)
        solved += succeeded
    own_ms, ipopt_ms = 1e3 * np.array(own_times), 1e3 * np.array(ipopt_times)
    return {
        "ipopt.problems": float(len(problems)),
        "ipopt.solved_share": solved / len(problems),
        "ipopt.own_median_ms": float(np.median(own_ms)),
        "ipopt.median_ms": float(np.median(ipopt_ms)),
        "ipopt.p99_ms": float(np.percentile(ipopt_ms, 99)),
        "ipopt.ratio": float(np.median(ipopt_ms) / np.median(own_ms)),
    }


def contacts(moments: list[Moment], scene: Scene, settings: BandSettings) -> tuple[int, int]:
    """Updates during which the robot moves and touches something, and those in which it stands and is touched."""
    moving = standing = 0
    for moment in moments:
        trajectory = moment.result.trajectory
        assert trajectory is not None
        offsets = np.linspace(0.0, PERIOD_S, 11)
        states, inputs = trajectory.at(trajectory.stamp_ns, offsets)
        around = Surroundings.of(
            scene.points,
            np.zeros((0, 2, 2)),
            scene.movers_at(moment.now_s),
            stamp_ns=trajectory.stamp_ns,
            frame_id=settings.frame_id,
        )
        touching = clearances(offsets, states, around, settings.footprint, 0.1) <= 0.0
        moves = np.abs(inputs[:, 0]) + 0.4 * np.abs(inputs[:, 1]) > 0.01
        moving += bool((touching & moves).any())
        standing += bool((touching & ~moves).any())
    return moving, standing


def crowded(
    band: TimedElasticBand, name: str, scene_of: Callable[[int], Scene], runs: int, seconds: float
) -> dict[str, float]:
    """Contacts and arrivals over seeded scenes."""
    totals: Counter[str] = Counter()
    for seed in range(SEED + 200, SEED + 200 + runs):
        scene = scene_of(seed)
        moments = list(driven(band, scene, seed=seed, seconds=seconds))
        moving, standing = contacts(moments, scene, band.settings)
        totals["contacts_moving"] += moving > 0
        totals["contacts_standing"] += standing > 0
        totals.update(moment.result.kind for moment in moments)
    updates = sum(totals[kind] for kind in ("band", "slower", "other side", "stop", "arrived"))
    shown = ", ".join(f"{kind} {totals[kind]}" for kind in ("band", "slower", "other side", "stop"))
    print(f"  {name:<10} {runs} runs, {updates} updates ({shown}): {totals['arrived']} arrived")
    print(
        f"  {'':<10} {totals['contacts_moving']} runs with a contact while moving, "
        f"{totals['contacts_standing']} in which the standing robot was touched"
    )
    keys = ("contacts_moving", "contacts_standing")
    figures = {f"{name}.{key}": float(totals[key]) for key in keys}
    return figures | {f"{name}.arrived_share": totals["arrived"] / runs}


def main() -> None:
    """Measure, print, write out/band/metrics.json."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--quick", action="store_true", help="few runs: shows that it works, not how well")
    quick = parser.parse_args().quick
    settings = BandSettings.from_robot(load_robot())
    band = TimedElasticBand(settings)
    replan_times(band, 1)
    times = replan_times(band, 2 if quick else 20)
    figures = {
        "replan.median_ms": float(np.median(times)),
        "replan.p99_ms": float(np.percentile(times, 99)),
        "replan.max_ms": float(times.max()),
    }
    print(
        f"replan, {len(times)} updates: median {figures['replan.median_ms']:.2f} ms, "
        f"p99 {figures['replan.p99_ms']:.2f} ms, longest {figures['replan.max_ms']:.2f} ms"
    )
    peer = against_ipopt(settings, 1 if quick else 4)
    ratio, count = peer["ipopt.ratio"], peer["ipopt.problems"]
    print(f"one band of {INTERVALS} intervals, {count:.0f} problems: {ratio:.1f} times faster than IPOPT")
    print(f"  own median {peer['ipopt.own_median_ms']:.2f} ms")
    print(f"  IPOPT median {peer['ipopt.median_ms']:.2f} ms, p99 {peer['ipopt.p99_ms']:.1f} ms")
    print(f"  IPOPT solved {100.0 * peer['ipopt.solved_share']:.0f} %")
    print("crowded scenes")
    figures |= peer
    figures |= crowded(band, "random", random_scene, 3 if quick else 40, 60.0)
    figures |= crowded(band, "hard", hard_scene, 3 if quick else 20, 40.0)
    write_metrics("band", {f"band.{key}": value for key, value in figures.items()}, seed=SEED)


if __name__ == "__main__":
    main()
