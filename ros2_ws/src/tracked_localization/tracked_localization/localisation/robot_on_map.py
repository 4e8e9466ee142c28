"""Everything between a map, scans and odometry on one side and where the robot is on the other.

Somebody says where the robot is, or the whole map is searched for it; then scans are followed. When they fit no
longer the robot is lost, which is said, and the map is searched anew.
"""

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from tracked_localization.localisation.global_search import Found, MapSearch, Nearby, SearchSettings, find_on_map
from tracked_localization.localisation.localiser import Localised, Localiser, LocaliserSettings
from tracked_localization.localisation.odometry_anchor import AnchorSettings, OdometryAnchor
from tracked_localization.matching.scan_alignment import AlignedScan
from tracked_localization.matching.scan_matcher import MatchSettings, match_scan
from tracked_localization.matching.wall_field import WallField
from tracked_types import OccupancyMap, Pose2, PoseSample, seconds_between
from tracked_types.setting import check_settings, setting

Array = NDArray[np.float64]
_FOUND = np.diag([0.01, 0.01, 0.003])  # covariance of a place that a search has found


class Phase(Enum):
    """What is known; the value is how people are told."""

    NO_MAP = "no map"
    NO_POSE = "nobody has said where the robot is"
    SEARCHING = "searching the map"
    AMBIGUOUS = "several places look alike"
    CONVERGING = "not sure yet"
    LOCALISED = "localised"
    LOST = "lost"


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotOnMapSettings:
    """What happens when nobody knows where the robot is."""

    correct_odometry: bool = setting(
        False,
        "tell scan matches on `pose`, for ekf to follow (its fuse_pose); map -> odom then keeps still",
    )
    relocalise_when_lost: bool = setting(True, "search the whole map when lost, and at the start without a pose")
    search_again_s: float = setting(
        5.0, "search again so long after a search that found no place, or several", unit="s", low=0.1, high=3600.0
    )
    search_pieces: int = setting(
        2, "pieces of a search, of some milliseconds each, done per odometry message", low=1, high=1000
    )
    converged_scans: int = setting(
        3, "so many scans must fit one after the other before the robot counts as localised", low=1, high=100
    )

    def __post_init__(self) -> None:
        check_settings(self)


@dataclass(frozen=True, slots=True)
class OnMap:
    """What one scan says.

    odom_in_map: the odometry's frame in the map. measured: the scan's own word on the pose, for the odometry filter.
    """

    localised: Localised
    odom_in_map: Pose2
    measured: PoseSample | None


@dataclass(frozen=True, slots=True)
class _Given:
    """A pose that somebody gave; odom_pose: of the base at its instant, None if that is not known."""

    pose: Pose2
    covariance: Array | None
    odom_pose: Pose2 | None
    near: bool


@dataclass(frozen=True, slots=True)
class _Search:
    work: MapSearch
    odom_pose: Pose2


class RobotOnMap:
    """Takes maps, given poses and aligned scans, and the stamps of the odometry, at which it works on searches."""

    def __init__(
        self,
        settings: RobotOnMapSettings,
        localiser: LocaliserSettings,
        matching: MatchSettings,
        searching: SearchSettings,
        anchor: AnchorSettings,
        odom_frame: str = "odom",
    ) -> None:
        self._settings, self._localiser_settings = settings, localiser
        self._matching, self._searching, self._odom_frame = matching, searching, odom_frame
        self._anchor = OdometryAnchor(anchor)
        self._map: OccupancyMap | None = None
        self._field: WallField | None = None
        self._localiser: Localiser | None = None
        self._given: _Given | None = None
        self._search: _Search | None = None
        self._searched_ns: int | None = None
        self._newest: AlignedScan | None = None
        self._fitting = 0
        self.phase = Phase.NO_MAP
        self.reason = ""
        self.candidates: tuple[Found, ...] = ()
        self.unfollowed = 0
        """How often the odometry did not follow the scans for long, so that its frame was pinned anew."""

    def set_map(self, occupancy_map: OccupancyMap) -> None:
        """Localise on this map from now on; where the robot is has to be found anew, unless it was known before.

        Raises
        ------
        ValueError: no cell of the map is occupied, or none is free. The map before stays.
        """
        if not ((occupancy_map.occupancy >= 0) & ~occupancy_map.occupied).any():
            raise ValueError("the map has no free cell")
        field = WallField(occupancy_map)
        if self._localiser is not None and self._newest is not None and self._given is None:
            self._given = _Given(self._localiser.pose, None, self._newest.odom_pose, near=False)
        self._map, self._field = occupancy_map, field
        self._localiser, self._search, self._searched_ns = None, None, None
        self._enter(Phase.NO_POSE if self._given is None else Phase.CONVERGING)

    def set_pose(self, pose: Pose2, covariance: Array | None = None, odom_pose: Pose2 | None = None) -> None:
        """Somebody says where the base is in the map; ``odom_pose`` is where the odometry had it at that instant.

        Raises
        ------
        ValueError: pose or covariance (3, 3) are not finite, or the covariance is none.
        """
        if covariance is not None and not np.any(covariance):
            covariance = None
        if covariance is not None:
            covariance = np.asarray(covariance, np.float64) + np.diag([1e-4, 1e-4, 1e-5])
        if not np.isfinite(pose.as_array()).all() or (covariance is not None and not np.isfinite(covariance).all()):
            raise ValueError("pose and covariance must be finite")
        self._given, self._search = _Given(pose, covariance, odom_pose, near=True), None
        if self._map is not None:
            self._enter(Phase.CONVERGING)

    def search_now(self) -> str:
        """Search the whole map with the newest scan; the reason if no one place stands out, which changes nothing."""
        if self._map is None or self._field is None:
            return Phase.NO_MAP.value
        if self._newest is None:
            return "no scan yet"
        scan = self._newest
        found = find_on_map(self._map, self._field, scan.points, self._searching, self._matching)
        reason = self._judge(found)
        if not reason:
            self._search = None
            self._given = _Given(found[0].pose, _FOUND, scan.odom_pose, near=False)
            self._enter(Phase.CONVERGING)
        return reason

    def work(self, now_ns: int) -> None:
        """The odometry is at ``now_ns``: notice that scans have ceased, and do a little of a search under way."""
        if self._newest is not None and self.phase in (Phase.LOCALISED, Phase.CONVERGING):
            silent_s = seconds_between(now_ns, self._newest.points.stamp_ns)
            if silent_s > self._localiser_settings.lost_after_s:
                self._enter(Phase.LOST, f"no scan for {self._localiser_settings.lost_after_s:g} s")
        if self._search is None:
            return
        for _ in range(self._settings.search_pieces):
            if self._search.work.step():
                self._end_search(self._search)
                return

    def add(self, scan: AlignedScan) -> OnMap | None:
        """Take one scan in; None while nothing is known of where the robot is."""
        if self._newest is not None and scan.points.stamp_ns < self._newest.points.stamp_ns:
            self._start_anew(scan)
        self._newest = scan
        if self._map is None:
            return None
        if self._given is not None:
            self._begin(self._given, scan)
        if self._localiser is None:
            self._maybe_search(scan)
            return None
        pinned = self._anchor.odom_in_map
        expected = None if pinned is None else pinned.compose(scan.odom_pose)
        localised = self._localiser.add(scan.points, scan.odom_pose, expected)
        self._follow(localised, scan)
        return self._answer(localised, scan)

    def _answer(self, localised: Localised, scan: AlignedScan) -> OnMap:
        assert self._localiser is not None
        measured, pinned = None, self._anchor.odom_in_map
        if pinned is not None and localised.used:
            information = self._localiser.information(localised.match)
            stamp_ns = localised.stamp_ns
            measured = self._anchor.measured(localised.match.pose, information, stamp_ns, self._odom_frame)
        return OnMap(localised, pinned or localised.odom_in_map, measured)

    def _begin(self, given: _Given, scan: AlignedScan) -> None:
        """Start from a given pose, moved as odometry has moved since."""
        assert self._field is not None
        pose = given.pose
        if given.odom_pose is not None:
            pose = pose.compose(given.odom_pose.inverse().compose(scan.odom_pose))
        if given.near:
            pose = self._best_near(pose, given.covariance, scan)
        self._given = None
        self._localiser = Localiser(self._localiser_settings, self._matching, self._field, pose, given.covariance)

    def _best_near(self, pose: Pose2, covariance: Array | None, scan: AlignedScan) -> Pose2:
        """The place that the scan fits best among those that the given pose may mean."""
        assert self._map is not None and self._field is not None
        deviations = np.sqrt(np.diag(covariance)) if covariance is not None else np.array([0.5, 0.5, 0.26])
        radius_m = float(np.clip(3.0 * deviations[:2].max(), 0.3, 3.0))
        nearby = Nearby(pose, radius_m, float(np.clip(3.0 * deviations[2], 0.2, np.pi)))
        direct = match_scan(self._field, scan.points.hits, pose, self._matching)
        found = find_on_map(self._map, self._field, scan.points, self._searching, self._matching, nearby)
        better = [place for place in found if place.match.agreement > direct.agreement + 0.05]
        if not better or better[0].match.doubt(self._matching):
            return pose
        return min(better, key=lambda place: np.hypot(place.pose.x_m - pose.x_m, place.pose.y_m - pose.y_m)).pose

    def _follow(self, localised: Localised, scan: AlignedScan) -> None:
        """What this scan means for what is known."""
        stamp_ns = localised.stamp_ns
        self._fitting = self._fitting + 1 if localised.used else 0
        if localised.lost:
            if self.phase in (Phase.LOCALISED, Phase.CONVERGING):
                self._enter(Phase.LOST, localised.reason)
            self._maybe_search(scan)
        elif localised.used and self.phase is Phase.LOCALISED:
            if self._settings.correct_odometry:
                self.unfollowed += self._anchor.check(localised.pose, scan.odom_pose, stamp_ns)
        elif self._fitting >= self._settings.converged_scans and self._search is None:
            self._enter(Phase.LOCALISED)
            if self._settings.correct_odometry:
                self._anchor.pin(localised.odom_in_map, stamp_ns)

    def _maybe_search(self, scan: AlignedScan) -> None:
        if self._search is not None or not self._settings.relocalise_when_lost:
            return
        since_ns = self._searched_ns
        if since_ns is not None and seconds_between(scan.points.stamp_ns, since_ns) < self._settings.search_again_s:
            return
        assert self._map is not None and self._field is not None
        work = MapSearch(self._map, self._field, scan.points, self._searching, self._matching)
        self._search, self._searched_ns = _Search(work, scan.odom_pose), scan.points.stamp_ns
        self._enter(Phase.SEARCHING, self.reason)

    def _end_search(self, search: _Search) -> None:
        self._search = None
        found = search.work.found
        reason = self._judge(found)
        if not reason:
            self._given = _Given(found[0].pose, _FOUND, search.odom_pose, near=False)
            self._searched_ns = None
            self._enter(Phase.CONVERGING)
        elif len(found) > 1:
            self._enter(Phase.AMBIGUOUS, reason)
        else:
            self._enter(Phase.LOST, reason)

    def _judge(self, found: tuple[Found, ...]) -> str:
        """Why a search does not say where the robot is; empty if it does."""
        self.candidates = found
        if not found:
            return "the scan has too few points to search with"
        doubt = found[0].match.doubt(self._matching)
        if doubt:
            return f"the scan fits nowhere on the map: {doubt}"
        if len(found) == 1:
            return ""
        places = "; ".join(f"({p.pose.x_m:.2f}, {p.pose.y_m:.2f}, {p.pose.yaw_rad:.2f}): {p.score:.2f}" for p in found)
        return f"the scan fits {len(found)} places alike (x, y, yaw: score): {places}"

    def _enter(self, phase: Phase, reason: str = "") -> None:
        self.phase, self.reason = phase, reason
        if phase is not Phase.LOCALISED:
            self._fitting = 0
            self._anchor.loosen()

    def _start_anew(self, scan: AlignedScan) -> None:
        """The clock was set back: odometry before it means nothing; the robot is where it was."""
        self._search, self._searched_ns = None, None
        if self._localiser is not None and self._given is None:
            self._given = _Given(self._localiser.pose, None, scan.odom_pose, near=True)
        if self._map is not None:
            self._enter(Phase.CONVERGING if self._given is not None else Phase.NO_POSE)
