"""Worlds: schema of a world file, checked on loading."""

from collections.abc import Iterator
from importlib import resources
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, model_validator

from sim_bridge.solids import Finite, Friction, Positive, Solid, WorldObject, solids_of
from sim_bridge.walkers import Walker
from tracked_types import Pose2
from tracked_types.checked_yaml import CheckedFileError, CheckedModel, load_checked_yaml

Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$")]
SUFFIX = ".yaml"


class PlanarPose(CheckedModel):
    """Where a robot starts or is sent: position and heading on the floor."""

    x_m: Finite
    y_m: Finite
    yaw_rad: Finite = 0.0

    def pose(self) -> Pose2:
        """The same as the pose type that the stack shares."""
        return Pose2(self.x_m, self.y_m, self.yaw_rad)


class FrictionZone(CheckedModel):
    """Rectangle of the ground, seen from above, with friction of its own; of two that overlap the later one counts."""

    name: Name
    centre_m: tuple[Finite, Finite]
    size_m: tuple[Positive, Positive]
    yaw_rad: Finite = 0.0
    friction: Friction


class World(CheckedModel):
    """A floor at z = 0, objects and walkers on it, friction, and named places to start from and to go to."""

    name: Name
    description: str
    friction: Friction | None = None
    objects: tuple[WorldObject, ...] = ()
    walkers: tuple[Walker, ...] = ()
    friction_zones: tuple[FrictionZone, ...] = ()
    starts: dict[Name, PlanarPose]
    goals: dict[Name, PlanarPose] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _names_are_unique(self) -> "World":
        for kind, names in (
            ("objects and walkers", [solid.name for solid in self.solids()]),
            ("friction_zones", [zone.name for zone in self.friction_zones]),
        ):
            twice = sorted({name for name in names if names.count(name) > 1})
            if twice:
                raise ValueError(f"{kind}: names are used twice: {', '.join(twice)}")
        if not self.starts:
            raise ValueError("starts: at least one start pose is needed")
        return self

    def solids(self) -> Iterator[Solid]:
        """Every body of the world, with compound objects taken apart; walkers where they begin."""
        for item in self.objects:
            yield from solids_of(item)
        for walker in self.walkers:
            yield walker.solid()

    def start(self, name: str = "default") -> Pose2:
        """The start pose called ``name``.

        Raises
        ------
        ValueError: if the world has no such start; the text lists those it has.
        """
        return _named(self.starts, name, f"world {self.name}: no start")

    def goal(self, name: str) -> Pose2:
        """The goal pose called ``name``; raises as `start`."""
        return _named(self.goals, name, f"world {self.name}: no goal")


def _named(poses: dict[str, PlanarPose], name: str, complaint: str) -> Pose2:
    if name not in poses:
        raise ValueError(f"{complaint} {name!r}; there are: {', '.join(sorted(poses)) or 'none'}")
    return poses[name].pose()


def packaged_worlds() -> tuple[str, ...]:
    """Names of the worlds that come with the package."""
    files = (resources.files("sim_bridge") / "worlds").iterdir()
    return tuple(sorted(file.name.removesuffix(SUFFIX) for file in files if file.name.endswith(SUFFIX)))


def load_world(name_or_path: str | Path) -> World:
    """Read and check a world: one of `packaged_worlds` by its name, or a file by its path.

    Raises
    ------
    CheckedFileError: if there is no such world, or a key is missing, unknown or out of range.
    """
    text = str(name_or_path)
    if isinstance(name_or_path, Path) or text.endswith((SUFFIX, ".yml")) or "/" in text:
        return load_checked_yaml(World, Path(text))
    source: Any = resources.files("sim_bridge") / "worlds" / f"{text}{SUFFIX}"
    if text not in packaged_worlds():
        raise CheckedFileError(f"world {text!r}: neither a file nor one of: {', '.join(packaged_worlds())}")
    return load_checked_yaml(World, source, f"{text}{SUFFIX}")
