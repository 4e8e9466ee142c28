"""Finding the robot on the whole map from one scan, and saying so if the map has more than one such place."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from tracked_localization.matching.scan_matcher import Match, MatchSettings, match_scan
from tracked_localization.matching.scan_points import ScanPoints
from tracked_localization.matching.wall_field import WallField
from tracked_types import FREE, OccupancyMap, Pose2, wrap_angle
from tracked_types.setting import check_settings, setting

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchSettings:
    """How finely the map is searched, and what makes two places hard to tell apart."""

    search_step_m: float = setting(0.2, "distance of the places tried", unit="m", low=0.02, high=5.0)
    search_step_rad: float = setting(0.09, "distance of the headings tried", unit="rad", low=0.005, high=1.0)
    search_beams: int = setting(90, "points of the scan that are laid over each place", low=10, high=2000)
    search_candidates: int = setting(30, "places that are looked at closely", low=1, high=1000)
    search_ambiguity: float = setting(
        0.06, "a second place is as good as the first if its score is lower by less than this", low=0.0, high=1.0
    )

    def __post_init__(self) -> None:
        check_settings(self)


@dataclass(frozen=True, slots=True)
class Found:
    """A place that the scan fits. score: share of the points on walls less the share of beams through walls."""

    pose: Pose2
    score: float
    match: Match


def find_on_map(
    occupancy_map: OccupancyMap,
    field: WallField,
    points: ScanPoints,
    settings: SearchSettings,
    matching: MatchSettings,
) -> tuple[Found, ...]:
    """The best place and all that cannot be told from it, best first; empty if the scan has too few points.

    More than one place means that the answer is ambiguous.

    Raises
    ------
    ValueError: if the map has no free cell.
    """
    if len(points.hits) < settings.search_beams // 3:
        return ()
    chosen = np.unique(np.linspace(0, len(points.hits) - 1, settings.search_beams).astype(int))
    places, headings, scores = _coarse(occupancy_map, points.hits[chosen], settings)
    distinct: list[Found] = []
    for index in _peaks(places, headings, scores, settings):
        guess = Pose2(float(places[index[0], 0]), float(places[index[0], 1]), float(headings[index[1]]))
        match = match_scan(field, points.hits, guess, matching)
        score = match.agreement - _through_walls(occupancy_map, points, match.pose)
        if not any(_same(match.pose, other.pose, settings) and score <= other.score for other in distinct):
            distinct = [other for other in distinct if not _same(match.pose, other.pose, settings)]
            distinct.append(Found(match.pose, score, match))
    distinct.sort(key=lambda found: -found.score)
    return tuple(found for found in distinct if found.score >= distinct[0].score - settings.search_ambiguity)


def _coarse(occupancy_map: OccupancyMap, hits: Array, settings: SearchSettings) -> tuple[Array, Array, Array]:
    """Places (p, 2), headings (h,) and how well the hits fit at each, (p, h)."""
    free = np.argwhere(occupancy_map.occupancy == FREE)
    if not len(free):
        free = np.argwhere((occupancy_map.occupancy >= 0) & ~occupancy_map.occupied)
    if not len(free):
        raise ValueError("the map has no free cell")
    stride = max(1, round(settings.search_step_m / occupancy_map.resolution_m))
    places = occupancy_map.centres_of(free[(free % stride == 0).all(axis=1)])
    headings = np.arange(-np.pi, np.pi, settings.search_step_rad)
    vacant = (~occupancy_map.occupied).astype(np.uint8)
    distance = cv2.distanceTransform(vacant, cv2.DIST_L2, 3) * occupancy_map.resolution_m
    # A place may be half a step off, and its heading half a step turned: be as tolerant as that.
    fit = np.exp(-0.5 * (distance / (0.6 * settings.search_step_m)) ** 2).astype(np.float32)
    height, width = fit.shape
    scores = np.zeros((len(places), len(headings)))
    inward = occupancy_map.origin.inverse()
    for number, heading in enumerate(headings):
        offsets = Pose2(0.0, 0.0, inward.yaw_rad + float(heading)).transform(hits) / occupancy_map.resolution_m
        base = inward.transform(places) / occupancy_map.resolution_m
        column = (base[:, None, 0] + offsets[None, :, 0]).astype(np.intp)
        row = (base[:, None, 1] + offsets[None, :, 1]).astype(np.intp)
        inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
        found = fit[np.where(inside, row, 0), np.where(inside, column, 0)]
        scores[:, number] = (found * inside).mean(axis=1)
    return places, headings, scores


def _peaks(places: Array, headings: Array, scores: Array, settings: SearchSettings) -> list[tuple[int, int]]:
    """The best places and headings, each at least some steps from every better one."""
    chosen: list[tuple[int, int]] = []
    for flat in np.argsort(scores, axis=None)[::-1][: 50 * settings.search_candidates]:
        place, heading = np.unravel_index(flat, scores.shape)
        for other_place, other_heading in chosen:
            near = np.abs(places[place] - places[other_place]).max() < 2.5 * settings.search_step_m
            turn = abs(wrap_angle(float(headings[heading] - headings[other_heading])))
            if near and turn < 3.5 * settings.search_step_rad:
                break
        else:
            chosen.append((int(place), int(heading)))
            if len(chosen) == settings.search_candidates:
                break
    return chosen


def _through_walls(occupancy_map: OccupancyMap, points: ScanPoints, pose: Pose2) -> float:
    """Share of the beams that would have crossed something of the map on their way."""
    origin = np.array(points.origin)
    shares = np.linspace(0.1, 0.9, 17)
    lengths = np.hypot(*(points.hits - origin).T)
    short_of = np.maximum(lengths - 4.0 * occupancy_map.resolution_m, 0.0) / np.maximum(lengths, 1e-9)
    samples = origin + (shares * short_of[:, None])[:, :, None] * (points.hits - origin)[:, None, :]
    row, column, inside = occupancy_map.look_up(pose.transform(samples.reshape(-1, 2)))
    blocked = inside & occupancy_map.occupied[row, column]
    return float(np.any(blocked.reshape(len(points.hits), -1), axis=1).mean())


def _same(one: Pose2, other: Pose2, settings: SearchSettings) -> bool:
    near = np.hypot(one.x_m - other.x_m, one.y_m - other.y_m) < 1.5 * settings.search_step_m
    return bool(near and abs(wrap_angle(one.yaw_rad - other.yaw_rad)) < 3.0 * settings.search_step_rad)
