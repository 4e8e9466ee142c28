"""Maps as files: a picture and a YAML beside it, as map_server of Nav2 writes and reads them."""

import math
from pathlib import Path
from typing import Annotated, Any, Literal

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from tracked_types import FREE, OCCUPIED, UNKNOWN, OccupancyMap, Pose2
from tracked_types.checked_yaml import CheckedFileError, CheckedModel, load_checked_yaml

MOST_CELLS = 2**28
_FREE_GREY, _OCCUPIED_GREY, _UNKNOWN_GREY = 254, 0, 205
Finite = Annotated[float, Field(allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0.0, le=1.0, allow_inf_nan=False)]


class MapFileError(CheckedFileError):
    """A map cannot be read or written; the text names the file and what is wrong with it."""


class MapDescription(CheckedModel):
    """The YAML beside the picture.

    mode trinary: cells are free, occupied or unknown by the two thresholds. scale: between the thresholds the
    darkness is the occupancy. raw: the grey value is the occupancy, above 100 unknown. negate: bright is occupied.
    Below 0.196 for free, the grey of unknown cells (205, which is 0.1961 dark) is unknown to every reader.
    """

    image: Annotated[str, Field(min_length=1)]
    mode: Literal["trinary", "scale", "raw"] = "trinary"
    resolution: Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
    origin: tuple[Finite, Finite, Finite]
    negate: Annotated[int, Field(ge=0, le=1)] = 0
    occupied_thresh: Share = 0.65
    free_thresh: Share = 0.196


def save_map(occupancy_map: OccupancyMap, stem: Path) -> Path:
    """Write ``stem``.pgm and ``stem``.yaml (mode trinary) and return the YAML's path.

    Raises
    ------
    MapFileError: if they cannot be written.
    """
    description = MapDescription(
        image=f"{stem.name}.pgm",
        resolution=occupancy_map.resolution_m,
        origin=(occupancy_map.origin.x_m, occupancy_map.origin.y_m, occupancy_map.origin.yaw_rad),
    )
    occupancy = occupancy_map.occupancy
    grey = np.full(occupancy.shape, _UNKNOWN_GREY, np.uint8)
    grey[(occupancy >= 0) & (occupancy <= 100.0 * description.free_thresh)] = _FREE_GREY
    grey[occupancy >= 100.0 * description.occupied_thresh] = _OCCUPIED_GREY
    height, width = occupancy.shape[0], occupancy.shape[1]
    header = f"P5\n# {description.resolution:.6f} m/pix\n{width} {height}\n255\n"
    target = stem.with_name(f"{stem.name}.yaml")
    try:
        stem.with_name(description.image).write_bytes(header.encode() + grey[::-1].tobytes())
        target.write_text(
            f"image: {description.image}\nmode: {description.mode}\nresolution: {description.resolution!r}\n"
            f"origin: {list(description.origin)}\nnegate: {description.negate}\n"
            f"occupied_thresh: {description.occupied_thresh}\nfree_thresh: {description.free_thresh}\n"
        )
    except OSError as error:
        raise MapFileError(f"{error.filename or target}: the map cannot be written ({error.strerror})") from error
    return target


def load_map(path: Path, frame_id: str) -> OccupancyMap:
    """Read a map by its YAML.

    Raises
    ------
    CheckedFileError: if the YAML is missing, is not YAML, or a key is missing, unknown or out of range.
    MapFileError: if the thresholds contradict each other, or the picture is missing, unreadable or too large.
    """
    description = load_checked_yaml(MapDescription, path)
    if description.free_thresh >= description.occupied_thresh:
        raise MapFileError(
            f"{path}: free_thresh must be below occupied_thresh {description.occupied_thresh:g}, "
            f"got {description.free_thresh:g}"
        )
    if "/" not in description.image and not (path.parent / description.image).exists():
        raise MapFileError(f"{path}: image {description.image} is not beside it")
    grey, opacity = _picture(path.parent / description.image)
    x_m, y_m, yaw_rad = description.origin
    origin = Pose2(x_m, y_m, math.remainder(yaw_rad, 2.0 * math.pi))
    return OccupancyMap(frame_id, description.resolution, origin, _occupancy(grey[::-1], opacity[::-1], description))


def _picture(path: Path) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Brightness 0 to 255, (height, width), and whether a pixel says anything (is opaque)."""
    try:
        content = np.frombuffer(path.read_bytes(), np.uint8)
    except OSError as error:
        raise MapFileError(f"{path}: the map's picture cannot be read ({error.strerror})") from error
    try:
        pixels: Any = cv2.imdecode(content, cv2.IMREAD_UNCHANGED) if content.size else None
    except cv2.error as error:  # more pixels than OpenCV opens
        raise MapFileError(f"{path}: the map's picture cannot be opened ({error.err})") from error
    if pixels is None or pixels.size == 0:
        raise MapFileError(f"{path}: is not a picture that can be opened")
    if pixels.shape[0] * pixels.shape[1] > MOST_CELLS:
        raise MapFileError(f"{path}: has {pixels.shape[1]} x {pixels.shape[0]} cells, more than {MOST_CELLS}")
    if pixels.dtype != np.uint8:
        pixels = pixels.astype(np.float64) * (255.0 / np.iinfo(pixels.dtype).max)
    if pixels.ndim == 2:
        return pixels.astype(np.float64), np.ones(pixels.shape, np.bool_)
    channels = pixels.shape[2]
    opaque = pixels[:, :, -1] > 0 if channels in (2, 4) else np.ones(pixels.shape[:2], np.bool_)
    colours = channels - 1 if channels in (2, 4) else channels
    return pixels[:, :, :colours].mean(axis=2), opaque


def _occupancy(grey: NDArray[np.float64], opaque: NDArray[np.bool_], description: MapDescription) -> NDArray[np.int8]:
    dark = grey / 255.0 if description.negate else (255.0 - grey) / 255.0
    if description.mode == "raw":
        value = np.round(grey)
        return np.where(value <= OCCUPIED, value, UNKNOWN).astype(np.int8)
    low, high = description.free_thresh, description.occupied_thresh
    between = np.full(grey.shape, float(UNKNOWN))
    if description.mode == "scale":
        between = np.where(opaque, np.rint(100.0 * (dark - low) / (high - low)), UNKNOWN)
    return np.where(dark >= high, OCCUPIED, np.where(dark <= low, FREE, between)).astype(np.int8)
