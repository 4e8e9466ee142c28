"""A world seen from above, for drawing it."""

from collections.abc import Iterator

from sim_bridge.solids import Ramp, Slats, Solid, Step, solids_of
from sim_bridge.world import World
from tracked_types import Outline, OutlineKind

_MILLIMETRES = 1000.0


def floor_plan(world: World) -> tuple[Outline, ...]:
    """Outlines of friction zones and objects, in the order in which they are to be drawn; tilted boxes as if level."""
    return (*_zones(world), *_objects(world))


def _zones(world: World) -> Iterator[Outline]:
    for zone in world.friction_zones:
        label = zone.name.replace("_", " ")
        yield Outline.box(*zone.centre_m, *zone.size_m, yaw_rad=zone.yaw_rad, kind="friction", label=label)


def _objects(world: World) -> Iterator[Outline]:
    for item in world.objects:
        label = ""
        if isinstance(item, Step | Ramp):
            label = f"{item.name.replace('_', ' ')}, {item.height_m * _MILLIMETRES:g} mm"
        for solid in solids_of(item):
            if isinstance(item, Step | Slats):
                yield _outline(solid, "step", label)
            elif isinstance(item, Ramp):
                yield _outline(solid, "ramp", label)
            elif solid.mass_kg > 0.0:
                yield _outline(solid, "movable", label)
            else:
                yield _outline(solid, "wall" if solid.shape == "box" else "obstacle", label)
    for walker in world.walkers:
        yield _outline(walker.solid(), "movable", f"{walker.name.replace('_', ' ')}, walks")


def _outline(solid: Solid, kind: OutlineKind, label: str) -> Outline:
    x, y, _ = solid.position_m
    length, width, height = solid.size_m
    if solid.shape == "cylinder":
        return Outline.circle(x, y, length / 2.0, kind=kind, label=label, height_m=height)
    yaw = solid.roll_pitch_yaw_rad[2]
    return Outline.box(x, y, length, width, yaw_rad=yaw, kind=kind, label=label, height_m=height)
