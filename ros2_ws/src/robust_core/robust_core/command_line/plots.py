"""Pictures of designs, proofs and maps; matplotlib is needed only here."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from robust_core.errors import MissingDependencyError
from robust_core.rational import Floats
from robust_core.theorems.regions import Region

# Okabe and Ito's colours, told apart by colour-blind readers.
COLOURS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00")
GREY = "#9aa5b1"
_STYLE: Any = {
    "svg.fonttype": "none",
    "svg.hashsalt": "robust_core",
    "font.size": 9.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#e4e7eb",
    "axes.edgecolor": GREY,
    "axes.titlelocation": "left",
    "axes.titleweight": "bold",
    "legend.frameon": False,
}


@contextmanager
def figure(width_in: float, height_in: float, path: Path) -> Iterator[Any]:
    """An empty figure that is saved at the end."""
    try:
        import matplotlib
        from matplotlib.figure import Figure
    except ImportError as error:
        raise MissingDependencyError("pictures are drawn with matplotlib, which is not installed") from error
    with matplotlib.rc_context(_STYLE):
        drawn = Figure(figsize=(width_in, height_in), layout="constrained")
        yield drawn
        drawn.savefig(path, format="svg", metadata={"Date": None, "Creator": None})


def draw_poles(
    figure: Any, groups: dict[str, Any], *, region: Region | None = None, decay: float = 0.0, discrete: bool = False
) -> None:
    """Eigenvalues of frozen matrices by group, and where they must lie."""
    ax = figure.subplots()
    everything = np.concatenate([np.ravel(np.linalg.eigvals(matrices)) for matrices in groups.values()])
    for k, (label, matrices) in enumerate(groups.items()):
        poles = np.ravel(np.linalg.eigvals(matrices))
        ax.scatter(poles.real, poles.imag, s=26, marker="xo"[k % 2], color=[GREY, COLOURS[0]][k % 2], label=label)
    if discrete:
        angle = np.linspace(0.0, 2.0 * np.pi, 361)
        ax.plot(np.cos(angle), np.sin(angle), color=COLOURS[2], lw=1, label="unit circle")
        ax.set_aspect("equal")
    else:
        ax.axvline(-decay, color=COLOURS[2], lw=1, label=f"decay {decay:g} 1/s" if decay else "stability")
        usual = float(np.median(np.abs(everything.real)))
        if region is None and np.abs(everything.real).max() > 20.0 * usual > 0.0:
            ax.set_xscale("symlog", linthresh=usual)
    if region is not None:
        _draw_region(ax, region, everything)
    ax.set(xlabel="real part", ylabel="imaginary part", title="poles of the frozen system")
    ax.legend(loc="best")


def _draw_region(ax: Any, region: Region, poles: Floats) -> None:
    reach = 1.2 * max(1.0, float(np.abs(poles).max()))
    real, imaginary = np.meshgrid(np.linspace(-2.0 * reach, reach, 301), np.linspace(-reach, reach, 301))
    inside = region.contains(real + 1j * imaginary)
    ax.contourf(real, imaginary, inside.astype(float), levels=[0.5, 1.5], colors=[COLOURS[2]], alpha=0.08)
    ax.set(xlim=(min(1.2 * poles.real.min(), -1.0), max(0.3 * reach, 1.2 * poles.real.max())), ylim=(-reach, reach))


def draw_gains(figure: Any, frequencies: Floats, gains: Floats, level: float, label: str, unit: str) -> None:
    """Gain of every vertex over frequency, and the level that is proven."""
    ax = figure.subplots()
    for k, gain in enumerate(gains):
        ax.loglog(frequencies, gain, color=COLOURS[k % len(COLOURS)], lw=1.4, label=f"vertex {k}")
    if np.isfinite(level):
        ax.axhline(level, color="#1f2933", lw=1, ls="--", label=label)
    ax.set(xlabel=f"frequency ({unit})", ylabel="gain", title="frozen response")
    ax.legend(loc="best", ncols=2)


def draw_map(figure: Any, points: Floats, names: Sequence[str], layers: Sequence[tuple[str, Any]]) -> None:
    """Points of a map: each in the colour of the first theorem that proves it, grey where none does."""
    ax = figure.subplots()
    rest = np.ones(len(points), dtype=bool)
    size = float(np.clip(9000.0 / len(points), 2.0, 60.0))
    y = points[:, 1] if points.shape[1] > 1 else np.zeros(len(points))
    for k, (label, proven) in enumerate(layers):
        new = rest & proven
        rest &= ~proven
        ax.scatter(points[new, 0], y[new], s=size, color=COLOURS[k % len(COLOURS)], label=label, lw=0)
    ax.scatter(points[rest, 0], y[rest], s=0.35 * size, color="#cbd2d9", label=f"none ({int(rest.sum())})", lw=0)
    ax.set(xlabel=names[0], ylabel=names[1] if len(names) > 1 else "", title="proven points")
    ax.legend(loc="center left", bbox_to_anchor=(1.01, 0.5))
