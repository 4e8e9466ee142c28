"""The map of a world as it is, drawn from its solids: what a mapper would make of it in the end."""

import cv2
import numpy as np

from sim_bridge.floor_plan import floor_plan
from sim_bridge.world import World
from tracked_types import FREE, OCCUPIED, UNKNOWN, OccupancyMap, Pose2

_ROOM_M = 0.5  # about everything


def true_map(
    world: World, *, resolution_m: float = 0.05, lidar_height_m: float, without: frozenset[str] = frozenset()
) -> OccupancyMap:
    """Occupied where something that cannot be pushed reaches up to the lidar; free elsewhere.

    ``without``: names of objects that the map does not show.

    Raises
    ------
    ValueError: if nothing of the world reaches up to the lidar.
    """
    shown = world.model_copy(
        update={"walkers": (), "objects": tuple(item for item in world.objects if item.name not in without)}
    )
    outlines = [
        np.array(outline.points)
        for outline in floor_plan(shown)
        if outline.kind in ("wall", "obstacle") and outline.height_m > lidar_height_m
    ]
    if not outlines:
        raise ValueError(f"world {world.name}: nothing reaches up to the lidar")
    corners = np.concatenate(outlines)
    # Faces usually lie on round numbers: half a cell away from them, no face lies between two cells.
    low = (np.floor((corners.min(axis=0) - _ROOM_M) / resolution_m) - 0.5) * resolution_m
    width, height = np.ceil((corners.max(axis=0) + _ROOM_M - low) / resolution_m).astype(int).tolist()
    occupancy = np.full((height, width), FREE, np.int8)
    mask = np.zeros((height, width), np.uint8)
    for outline in outlines:
        pixels = (outline - low) / resolution_m - 0.5
        cv2.polylines(mask, [np.rint(pixels * 16).astype(np.int32)], True, 1, 1, cv2.LINE_8, 4)
    occupancy[mask > 0] = OCCUPIED
    # What is outside the outermost walls no robot will ever see.
    filled = np.pad(mask, 1)
    cv2.floodFill(filled, None, (0, 0), 2)
    occupancy[filled[1:-1, 1:-1] == 2] = UNKNOWN
    return OccupancyMap("map", resolution_m, Pose2(float(low[0]), float(low[1]), 0.0), occupancy)
