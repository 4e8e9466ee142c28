"""What a world is made of: boxes and cylinders, and the objects that are taken apart into them."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from tracked_types.checked_yaml import CheckedModel

Finite = Annotated[float, Field(allow_inf_nan=False, ge=-1e4, le=1e4)]
Positive = Annotated[float, Field(gt=0.0, le=1e3, allow_inf_nan=False)]
# Contacts are stiff: a lighter body than this would be thrown about by one step's contact force.
Mass = Annotated[float, Field(ge=0.2, le=1e4, allow_inf_nan=False)]
Colour = tuple[float, float, float]
Vector = tuple[float, float, float]
GREY: Colour = (0.6, 0.6, 0.6)


class Friction(CheckedModel):
    """Coefficients of friction under a belt, along it and across it."""

    longitudinal: Annotated[float, Field(gt=0.0, le=2.0, allow_inf_nan=False)]
    lateral: Annotated[float, Field(gt=0.0, le=2.0, allow_inf_nan=False)]


@dataclass(frozen=True, slots=True)
class Solid:
    """One body: a box of ``size_m`` (length, width, height), or a cylinder of diameter, diameter, height.

    The position is that of its centre; ``mass_kg`` 0 means that it cannot be moved.
    """

    name: str
    shape: Literal["box", "cylinder"]
    size_m: Vector
    position_m: Vector
    roll_pitch_yaw_rad: Vector = (0.0, 0.0, 0.0)
    mass_kg: float = 0.0
    friction: Friction | None = None
    colour: Colour = GREY


class _Placed(CheckedModel):
    """What every object has: a name, a place, and maybe friction and a colour."""

    name: Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$")]
    position_m: tuple[Finite, Finite] | tuple[Finite, Finite, Finite]
    friction: Friction | None = None
    colour: Colour = GREY

    def centre_m(self, height_m: float) -> Vector:
        """Centre of a body of this height; with two numbers for its position it stands on the floor."""
        x, y, *rest = self.position_m
        return (x, y, rest[0] if rest else 0.5 * height_m)


class Box(_Placed):
    """Box of length, width and height; with a mass it can be pushed about."""

    shape: Literal["box"]
    size_m: tuple[Positive, Positive, Positive]
    roll_pitch_yaw_rad: tuple[Finite, Finite, Finite] = (0.0, 0.0, 0.0)
    mass_kg: Mass | None = None


class Cylinder(_Placed):
    """Upright cylinder (unless turned); with a mass it can be pushed about."""

    shape: Literal["cylinder"]
    radius_m: Positive
    height_m: Positive
    roll_pitch_yaw_rad: tuple[Finite, Finite, Finite] = (0.0, 0.0, 0.0)
    mass_kg: Mass | None = None


class Step(_Placed):
    """Step to drive over: a flat box on the floor, ``length_m`` along its heading; the position is its centre."""

    shape: Literal["step"]
    length_m: Positive
    width_m: Positive
    height_m: Positive
    yaw_rad: Finite = 0.0


class Ramp(_Placed):
    """Slope that rises from the floor at its position, along its heading, to ``height_m`` after ``length_m``."""

    shape: Literal["ramp"]
    length_m: Positive
    width_m: Positive
    height_m: Positive
    yaw_rad: Finite = 0.0


class Slats(_Placed):
    """Row of slats on the floor, across the heading, the first at the position; heights drawn with a seed."""

    shape: Literal["slats"]
    count: Annotated[int, Field(ge=1, le=200)]
    spacing_m: Positive
    length_m: Positive
    width_m: Positive
    height_min_m: Positive
    height_max_m: Positive
    seed: Annotated[int, Field(ge=0)]
    yaw_rad: Finite = 0.0

    @model_validator(mode="after")
    def _ordered(self) -> "Slats":
        if self.height_min_m > self.height_max_m:
            raise ValueError(f"height_min_m {self.height_min_m} exceeds height_max_m {self.height_max_m}")
        return self


WorldObject = Annotated[Box | Cylinder | Step | Ramp | Slats, Field(discriminator="shape")]


def solids_of(item: Box | Cylinder | Step | Ramp | Slats) -> Iterator[Solid]:
    """The bodies that an object of a world file stands for."""
    friction, colour = item.friction, item.colour
    if isinstance(item, Box):
        centre, mass_kg = item.centre_m(item.size_m[2]), item.mass_kg or 0.0
        yield Solid(item.name, "box", item.size_m, centre, item.roll_pitch_yaw_rad, mass_kg, friction, colour)
    elif isinstance(item, Cylinder):
        size, centre = (2.0 * item.radius_m, 2.0 * item.radius_m, item.height_m), item.centre_m(item.height_m)
        mass_kg = item.mass_kg or 0.0
        yield Solid(item.name, "cylinder", size, centre, item.roll_pitch_yaw_rad, mass_kg, friction, colour)
    elif isinstance(item, Step):
        size, turn = (item.length_m, item.width_m, item.height_m), (0.0, 0.0, item.yaw_rad)
        centre = item.centre_m(item.height_m)
        yield Solid(item.name, "box", size, centre, turn, friction=friction, colour=colour)
    elif isinstance(item, Ramp):
        yield _ramp(item)
    else:
        yield from _slats(item)


def _ramp(item: Ramp) -> Solid:
    """A tilted box, half sunk into the floor, whose upper face is the slope."""
    slope, run = math.atan2(item.height_m, item.length_m), math.hypot(item.length_m, item.height_m)
    x, y, z = item.centre_m(0.0)
    along = 0.5 * item.length_m + 0.5 * item.height_m * math.sin(slope)
    up = 0.5 * item.height_m - 0.5 * item.height_m * math.cos(slope)
    centre = (x + along * math.cos(item.yaw_rad), y + along * math.sin(item.yaw_rad), z + up)
    size, turn = (run, item.width_m, item.height_m), (0.0, -slope, item.yaw_rad)
    return Solid(item.name, "box", size, centre, turn, friction=item.friction, colour=item.colour)


def _slats(item: Slats) -> Iterator[Solid]:
    heights = np.random.default_rng(item.seed).uniform(item.height_min_m, item.height_max_m, item.count)
    x, y, z = item.centre_m(0.0)
    for index, height in enumerate(heights.tolist()):
        along = index * item.spacing_m
        centre = (x + along * math.cos(item.yaw_rad), y + along * math.sin(item.yaw_rad), z + 0.5 * height)
        size, turn = (item.length_m, item.width_m, height), (0.0, 0.0, item.yaw_rad)
        yield Solid(f"{item.name}_{index}", "box", size, centre, turn, friction=item.friction, colour=item.colour)
