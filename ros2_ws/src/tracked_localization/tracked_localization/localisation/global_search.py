"""Finding the robot on the whole map from one scan, and saying so if the map has more than one such place."""

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from tracked_localization.matching.scan_matcher import Match, MatchSettings, match_scan
from tracked_localization.matching.wall_field import WallField
from tracked_types import FREE, OccupancyMap, Pose2, wrap_angle
from tracked_types.scan_points import ScanPoints
from tracked_types.setting import check_settings, setting

Array = NDArray[np.float64]
_LARGEST_PIECE = 200_000  # points looked up in one piece of a search


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


@dataclass(frozen=True, slots=True)
class Nearby:
    """What part of the map to search: places within radius_m of ``pose`` and headings within turn_rad of its own."""

    pose: Pose2
    radius_m: float
    turn_rad: float


def find_on_map(
    occupancy_map: OccupancyMap,
    field: WallField,
    points: ScanPoints,
    settings: SearchSettings,
    matching: MatchSettings,
    nearby: Nearby | None = None,
) -> tuple[Found, ...]:
    """The best place and all that cannot be told from it, best first; empty if the scan has too few points.

    More than one place means that the answer is ambiguous.

    Raises
    ------
    ValueError: if the map has no free cell.
    """
    search = MapSearch(occupancy_map, field, points, settings, matching, nearby)
    while not search.step():
        pass
    return search.found


class MapSearch:
    """The search in small pieces, for who has other things to do in between.

    Raises
    ------
    ValueError: if the map has no free cell.
    """

    def __init__(
        self,
        occupancy_map: OccupancyMap,
        field: WallField,
        points: ScanPoints,
        settings: SearchSettings,
        matching: MatchSettings,
        nearby: Nearby | None = None,
    ) -> None:
        self._map, self._field, self._points = occupancy_map, field, points
        self._settings, self._matching = settings, matching
        self._distinct: list[Found] = []
        self.found: tuple[Found, ...] = ()
        self._work: Iterator[None] = iter(())
        if len(points.hits) >= settings.search_beams // 3:
            self._work = self._all(_places(occupancy_map, settings, nearby), _headings(settings, nearby))

    def step(self) -> bool:
        """Do one piece, some milliseconds of work; whether all is done and ``found`` holds the answer."""
        for _ in self._work:
            return False
        return True

    def _all(self, places: Array, headings: Array) -> Iterator[None]:
        """Every piece of the work, one after the other."""
        settings = self._settings
        if not len(places):
            return
        hits = self._points.hits
        chosen = np.unique(np.linspace(0, len(hits) - 1, settings.search_beams).astype(int))
        fit = _fit(self._map, settings)
        scores = np.zeros((len(places), len(headings)))
        most = max(1, _LARGEST_PIECE // len(chosen))
        for number, heading in enumerate(headings.tolist()):
            for first in range(0, len(places), most):
                piece = slice(first, first + most)
                scores[piece, number] = _scores(self._map, fit, places[piece], heading, hits[chosen])
                yield
        for place, number in _peaks(places, headings, scores, settings):
            self._look_closely(Pose2(float(places[place, 0]), float(places[place, 1]), float(headings[number])))
            yield
        self._distinct.sort(key=lambda found: -found.score)
        least = self._distinct[0].score - settings.search_ambiguity
        self.found = tuple(found for found in self._distinct if found.score >= least)

    def _look_closely(self, guess: Pose2) -> None:
        match = match_scan(self._field, self._points.hits, guess, self._matching)
        score = match.agreement - _through_walls(self._map, self._points, match.pose)
        same = [other for other in self._distinct if _same(match.pose, other.pose, self._settings)]
        if all(score > other.score for other in same):
            self._distinct = [other for other in self._distinct if other not in same]
            self._distinct.append(Found(match.pose, score, match))


def _places(occupancy_map: OccupancyMap, settings: SearchSettings, nearby: Nearby | None) -> Array:
    """Where to try the scan, (n, 2)."""
    free = np.argwhere(occupancy_map.occupancy == FREE)
    if not len(free):
        free = np.argwhere((occupancy_map.occupancy >= 0) & ~occupancy_map.occupied)
    if not len(free):
        raise ValueError("the map has no free cell")
    stride = max(1, round(settings.search_step_m / occupancy_map.resolution_m))
    places = occupancy_map.centres_of(free[(free % stride == 0).all(axis=1)])
    if nearby is None:
        return places
    away = places - np.array([nearby.pose.x_m, nearby.pose.y_m])
    near: Array = places[np.hypot(away[:, 0], away[:, 1]) <= nearby.radius_m]
    return near


def _headings(settings: SearchSettings, nearby: Nearby | None) -> Array:
    if nearby is None or nearby.turn_rad >= np.pi:
        return np.arange(-np.pi, np.pi, settings.search_step_rad, dtype=np.float64)
    each_side = int(np.ceil(nearby.turn_rad / settings.search_step_rad))
    around: Array = nearby.pose.yaw_rad + settings.search_step_rad * np.arange(
        -each_side, each_side + 1, dtype=np.float64
    )
    return around


def _fit(occupancy_map: OccupancyMap, settings: SearchSettings) -> NDArray[np.float32]:
    """How well a point fits in each cell. A place may be half a step off, its heading half a step turned."""
    vacant = (~occupancy_map.occupied).astype(np.uint8)
    distance = cv2.distanceTransform(vacant, cv2.DIST_L2, 3) * occupancy_map.resolution_m
    fit: NDArray[np.float32] = np.exp(-0.5 * (distance / (0.6 * settings.search_step_m)) ** 2).astype(np.float32)
    return fit


def _scores(
    occupancy_map: OccupancyMap, fit: NDArray[np.float32], places: Array, heading_rad: float, hits: Array
) -> Array:
    """How well the hits fit with the robot at each of the places and this heading, (n,)."""
    height, width = fit.shape
    inward = occupancy_map.origin.inverse()
    offsets = Pose2(0.0, 0.0, inward.yaw_rad + heading_rad).transform(hits) / occupancy_map.resolution_m
    base = inward.transform(places) / occupancy_map.resolution_m
    column = (base[:, None, 0] + offsets[None, :, 0]).astype(np.intp)
    row = (base[:, None, 1] + offsets[None, :, 1]).astype(np.intp)
    inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    found = fit[np.where(inside, row, 0), np.where(inside, column, 0)]
    scores: Array = (found * inside).mean(axis=1)
    return scores


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
