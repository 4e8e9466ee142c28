"""Transforms between frames over time. No ROS."""

from bisect import bisect_left, insort
from dataclasses import dataclass, field

from node_kit.rigid_transform import RigidTransform
from tracked_types import seconds_between, to_nanoseconds

_LONGEST_CHAIN = 64


class TransformError(LookupError):
    """A transform cannot be given; the text names the frames and the reason."""


@dataclass(slots=True)
class _Edge:
    """Motion of one frame in its parent; ``stamps_ns`` increases and is empty for a fixed edge."""

    parent: str
    fixed: RigidTransform | None = None
    stamps_ns: list[int] = field(default_factory=list)
    transforms: dict[int, RigidTransform] = field(default_factory=dict)

    def forget(self) -> None:
        self.stamps_ns.clear()
        self.transforms.clear()


class TransformBuffer:
    """Interpolating history of a tree of frames.

    history_s: how long transforms are kept.
    longest_gap_s: neighbours farther apart are not interpolated, since nothing is known in between.
    jump_s: a stamp this much older than the newest of its edge means that time jumped back: the edge starts anew.
    Smaller steps back are late messages and are sorted in.
    """

    def __init__(self, history_s: float = 10.0, longest_gap_s: float = 1.0, jump_s: float = 1.0) -> None:
        self._history_ns = to_nanoseconds(history_s)
        self._longest_gap_ns = to_nanoseconds(longest_gap_s)
        self._jump_ns = to_nanoseconds(jump_s)
        self._edges: dict[str, _Edge] = {}

    def add(self, parent: str, child: str, transform: RigidTransform, stamp_ns: int) -> None:
        """Note the pose of ``child`` in ``parent`` at ``stamp_ns``.

        Raises
        ------
        TransformError: a frame would be its own parent.
        """
        edge = self._edge(parent, child)
        edge.fixed = None
        stamps = edge.stamps_ns
        if stamps and stamp_ns < stamps[-1] - self._jump_ns:
            edge.forget()
        if stamp_ns not in edge.transforms:
            insort(stamps, stamp_ns)
        edge.transforms[stamp_ns] = transform
        expired = bisect_left(stamps, stamps[-1] - self._history_ns)
        for stamp in stamps[:expired]:
            del edge.transforms[stamp]
        del stamps[:expired]

    def add_static(self, parent: str, child: str, transform: RigidTransform) -> None:
        """Note the pose of ``child`` in ``parent`` for all time.

        Raises
        ------
        TransformError: a frame would be its own parent.
        """
        edge = self._edge(parent, child)
        edge.forget()
        edge.fixed = transform

    def clear_moving(self) -> None:
        """Forget everything that is not static, as after a jump of the clock."""
        for edge in self._edges.values():
            edge.forget()

    def lookup(self, target: str, source: str, stamp_ns: int | None = None) -> RigidTransform:
        """Pose of ``source`` in ``target`` at ``stamp_ns``, or at the newest instant all edges share.

        Raises
        ------
        TransformError: a frame is unknown, the frames are not connected, or there is no data for that instant.
        """
        target_chain, source_chain = self._chain(target), self._chain(source)
        common = next((frame for frame in source_chain if frame in target_chain), None)
        if common is None:
            unknown = [frame for frame in (target, source) if not self._is_known(frame)]
            reason = f"{' and '.join(unknown)} unknown" if unknown else "they are not connected"
            raise TransformError(f"no transform from {source} to {target}: {reason}")
        up_from_target = target_chain[: target_chain.index(common)]
        up_from_source = source_chain[: source_chain.index(common)]
        if stamp_ns is None:
            stamp_ns = self._newest_common(up_from_target + up_from_source)
        source_in_common = self._along(up_from_source, stamp_ns)
        target_in_common = self._along(up_from_target, stamp_ns)
        return target_in_common.inverse().compose(source_in_common)

    def _edge(self, parent: str, child: str) -> _Edge:
        if parent == child:
            raise TransformError(f"{child} cannot be its own parent")
        edge = self._edges.get(child)
        if edge is None or edge.parent != parent:
            edge = self._edges[child] = _Edge(parent)
        return edge

    def _is_known(self, frame: str) -> bool:
        return frame in self._edges or any(edge.parent == frame for edge in self._edges.values())

    def _chain(self, frame: str) -> list[str]:
        """``frame``, its parent, and so on to the root."""
        chain = [frame]
        while (edge := self._edges.get(chain[-1])) is not None:
            chain.append(edge.parent)
            if len(chain) > _LONGEST_CHAIN:
                raise TransformError(f"the parents of {frame} form a loop or an endless chain")
        return chain

    def _newest_common(self, frames: list[str]) -> int:
        moving = [frame for frame in frames if self._edges[frame].fixed is None]
        for frame in moving:
            if not self._edges[frame].stamps_ns:
                raise TransformError(f"no data yet for {frame} in {self._edges[frame].parent}")
        return min((self._edges[frame].stamps_ns[-1] for frame in moving), default=0)

    def _along(self, frames: list[str], stamp_ns: int) -> RigidTransform:
        """Pose of the first frame in the parent of the last."""
        result = RigidTransform.identity()
        for frame in frames:
            result = self._at(frame, stamp_ns).compose(result)
        return result

    def _at(self, frame: str, stamp_ns: int) -> RigidTransform:
        edge = self._edges[frame]
        if edge.fixed is not None:
            return edge.fixed
        exact = edge.transforms.get(stamp_ns)
        if exact is not None:
            return exact
        called = f"{frame} in {edge.parent}"
        stamps = edge.stamps_ns
        if not stamps:
            raise TransformError(f"no data yet for {called}")
        after = bisect_left(stamps, stamp_ns)
        if after == 0:
            raise TransformError(f"{called}: asked {seconds_between(stamps[0], stamp_ns):g} s before the oldest")
        if after == len(stamps):
            raise TransformError(f"{called}: asked {seconds_between(stamp_ns, stamps[-1]):g} s after the newest")
        before_ns, after_ns = stamps[after - 1], stamps[after]
        if after_ns - before_ns > self._longest_gap_ns:
            raise TransformError(f"{called}: nothing known for {seconds_between(after_ns, before_ns):g} s around it")
        weight = (stamp_ns - before_ns) / (after_ns - before_ns)
        return edge.transforms[before_ns].interpolate(edge.transforms[after_ns], weight)
