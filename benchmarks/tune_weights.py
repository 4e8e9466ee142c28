"""Random search for the weights of nmpc_layers/data/weights.yaml on the kinematic plant; prints the file.

Seeds from 1000 on are for tuning only: no figure is reported on them. Every role gets the same number of trials. The
score is the mean over the seeds of RMS and peak-to-peak errors against the reference in the estimated frame, each over
a typical value, plus a little for how much consecutive commands differ.
"""

import argparse
import tempfile
from dataclasses import asdict
from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray

from nmpc_layers import load_weights
from nmpc_layers.solver import Weights
from tracked_description import load_robot
from tracked_lab.closed_loop import ClosedLoop
from tracked_lab.kinematic_ground import Ground
from tracked_lab.kinematic_plant import KinematicPlant
from tracked_lab.stack import Stack
from tracked_lab.tracking import tracking_error
from tracked_navigation import Phase

Array = NDArray[np.float64]
SEEDS = (1000, 1001, 1002, 1003)
SHAPES = ("s_curve", "figure_eight")
LATENCY_S = 0.1
TYPICAL = np.array([0.02, 0.02, 0.06])  # m, m, rad
ROBOT = load_robot()


def score(method: str, layers: str, weights_file: str) -> float:
    """Mean score of one set of weights over all seeds; shapes alternate with them."""
    total = 0.0
    for number, seed in enumerate(SEEDS):
        common = {"method": method, "pipeline_latency_s": LATENCY_S, "weights_file": weights_file}
        parameters = {
            "trajectory_player": {"shape": SHAPES[number % len(SHAPES)], "start_delay_s": 0.6},
            "upper_nmpc": {"layers": layers, "final_approach": False, **common},
            "lower_nmpc": common,
        }
        plant = KinematicPlant(ROBOT, seed, Ground.of_seed(seed, obstacle=True, begin_s=1.0))
        errors, commands = run(plant, Stack(ROBOT, parameters))
        rms = np.sqrt(np.mean(errors**2, axis=0)) / TYPICAL
        peak = np.ptp(errors, axis=0) / (4.0 * TYPICAL)
        nervous = np.sqrt(np.mean(np.diff(commands, axis=0) ** 2, axis=0)) / np.array([0.05, 0.2])
        total += float(rms.sum() + 0.5 * peak.sum() + 0.3 * nervous.sum()) / len(SEEDS)
    return total


def run(plant: KinematicPlant, stack: Stack) -> tuple[Array, Array]:
    """Errors (n, 3) of the estimated pose along the reference, and commands (m, 2)."""
    errors, commands, piece = [], [], None
    loop = ClosedLoop(plant, stack)
    while stack.player.progress < 1.0:
        for reaction in loop.tick():
            piece = reaction.player.reference or piece
            if reaction.sent is not None:
                commands.append([reaction.sent.twist.speed_mps, reaction.sent.twist.yaw_rate_radps])
            if piece is not None and stack.player.phase is Phase.PLAYING:
                errors.append(tracking_error(reaction.estimate.odometry, piece))
    return np.array(errors), np.array(commands)


def drawn(generator: np.random.Generator) -> Weights:
    """Weights at random; only their ratios matter, so the position's stays."""

    def between(low: float, high: float) -> float:
        return round(float(np.exp(generator.uniform(np.log(low), np.log(high)))), 2)

    return Weights(
        position=20.0,
        heading=between(0.5, 20.0),
        speed=between(0.1, 5.0),
        yaw_rate=between(0.03, 3.0),
        terminal=float(generator.choice([1.0, 3.0, 8.0])),
    )


def tuned(method: str, trials: int, folder: Path) -> dict[str, Weights]:
    """The best weights of each role; the layers of the double structure are drawn together."""
    before = load_weights().of(method)
    best = {"single": before.single, "upper": before.upper, "lower": before.lower}
    for layers, roles in (("single", ("single",)), ("double", ("upper", "lower"))):
        generator, least = np.random.default_rng(0), np.inf
        for trial in range(trials):
            weights = best | ({} if trial == 0 else {role: drawn(generator) for role in roles})
            entry = {role: asdict(value) for role, value in weights.items()}
            path = folder / "weights.yaml"
            path.write_text(yaml.safe_dump({"improved": entry, "thesis": entry}))
            reached = score(method, layers, str(path))
            if reached < least:
                least, best = reached, weights
                print(f"# {method} {layers}: trial {trial} scores {reached:.3f}", flush=True)
    return best


def main() -> None:
    """Search and print the YAML."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--trials", type=int, default=30, help="per method and structure")
    trials = parser.parse_args().trials
    with tempfile.TemporaryDirectory() as folder:
        for method in ("improved", "thesis"):
            print(f"{method}:")
            for role, weights in tuned(method, trials, Path(folder)).items():
                entry = ", ".join(f"{key}: {value}" for key, value in asdict(weights).items())
                print(f"  {role}: {{{entry}}}", flush=True)


if __name__ == "__main__":
    main()
