import math

import numpy as np
import pytest

from tracked_description import load_robot
from tracked_navigation import (
    NamedTrajectory,
    Phase,
    PlayerOutput,
    PlayerSettings,
    ReferenceSettings,
    TrajectoryPlayer,
    make_reference,
)
from tracked_navigation.shape_settings import ShapeSettings
from tracked_types import Odometry, PeriodGrid, Pose2, Trajectory, Twist2

GRID = PeriodGrid(60)
ORIGIN = Pose2(0.0, 0.0, 0.0)
REST = Twist2(0.0, 0.0)


def line(length: float = 1.0) -> NamedTrajectory:
    return make_reference(load_robot(), ReferenceSettings(), ShapeSettings(shape="line", length_m=length))


def odometry(stamp_ns: int, pose: Pose2 = ORIGIN, twist: Twist2 = REST) -> Odometry:
    return Odometry(stamp_ns, "odom", "base_footprint", pose, twist, np.eye(3), np.eye(2))


def play(player: TrajectoryPlayer, first: int, last: int, pose: Pose2 = ORIGIN) -> list[PlayerOutput]:
    return [player.update(odometry(GRID.stamp_ns(index), pose)) for index in range(first, last)]


def pieces(outputs: list[PlayerOutput]) -> list[Trajectory]:
    return [output.reference for output in outputs if output.reference is not None]


def test_pieces_come_at_5_hz_instants_and_carry_them() -> None:
    found = pieces(play(TrajectoryPlayer(PlayerSettings(), line()), 60, 121))
    assert [piece.stamp_ns for piece in found] == [1_000_000_000 + k * 200_000_000 for k in range(6)]
    assert found[0].times_s == pytest.approx(np.arange(61) * 0.05)


def test_the_first_odometry_gets_a_piece_at_once() -> None:
    piece = TrajectoryPlayer(PlayerSettings(), line()).update(odometry(GRID.stamp_ns(61))).reference
    assert piece is not None and piece.stamp_ns == 1_000_000_000


def test_late_odometry_still_gets_the_piece_of_the_last_instant() -> None:
    player = TrajectoryPlayer(PlayerSettings(), line())
    player.update(odometry(1_000_000_000))
    piece = player.update(odometry(1_713_000_000)).reference
    assert piece is not None and piece.stamp_ns == 1_600_000_000


def test_shape_starts_at_the_pose_of_the_first_odometry() -> None:
    player = TrajectoryPlayer(PlayerSettings(), line(2.0))
    play(player, 60, 61, Pose2(3.0, -1.0, math.pi / 2))
    assert player.goal is not None
    assert player.goal.as_array() == pytest.approx([3.0, 1.0, math.pi / 2], abs=1e-9)


def test_shape_can_be_given_in_the_odometry_frame() -> None:
    player = TrajectoryPlayer(PlayerSettings(anchor="odom"), line(2.0))
    play(player, 60, 61, Pose2(3.0, -1.0, 1.0))
    assert player.goal is not None and player.goal.as_array() == pytest.approx([2.0, 0.0, 0.0], abs=1e-9)


def test_start_and_goal_are_held_with_zero_inputs() -> None:
    player = TrajectoryPlayer(PlayerSettings(start_delay_s=1.0), line())
    found = pieces(play(player, 0, 60 * 8))
    assert np.all(found[0].inputs[found[0].times_s <= 1.0] == 0.0)
    assert np.all(found[0].states[found[0].times_s <= 1.0] == 0.0)
    assert np.any(found[0].inputs[:, 0] > 0.1)
    assert np.all(found[-1].inputs == 0.0)
    assert found[-1].states[:, 0] == pytest.approx(1.0)


def test_the_start_does_not_depend_on_lost_first_messages() -> None:
    starts = set()
    for first in (1, 2, 30, 59):
        found = pieces(play(TrajectoryPlayer(PlayerSettings(), line()), first, 130))
        starts.add(found[-1].stamp_ns + round(1e9 * found[-1].times_s[found[-1].inputs[:, 0] > 0.0][0]))
    assert len(starts) == 1


def test_neighbouring_pieces_agree_where_they_overlap() -> None:
    early, late = pieces(play(TrajectoryPlayer(PlayerSettings(), line()), 0, 130))[-2:]
    offsets = np.linspace(0.2, 2.8, 100)
    for a, b in zip(early.at(late.stamp_ns, offsets), late.at(late.stamp_ns, offsets), strict=True):
        assert a == pytest.approx(b, abs=1e-12)


def test_arrival_is_reported_once() -> None:
    player = TrajectoryPlayer(PlayerSettings(), line())
    play(player, 0, 60)
    outputs = play(player, 60, 600, Pose2(0.98, 0.01, 0.02))
    reached = [output.reached for output in outputs if output.reached is not None]
    assert len(reached) == 1 and player.phase is Phase.REACHED
    assert reached[0].position_error_m == pytest.approx(math.hypot(0.02, 0.01))
    assert reached[0].yaw_error_rad == pytest.approx(0.02)
    assert reached[0].trajectory == "line"


@pytest.mark.parametrize(
    ("pose", "twist"),
    [
        (Pose2(0.9, 0.0, 0.0), REST),
        (Pose2(1.0, 0.0, 0.2), REST),
        (Pose2(1.0, 0.0, 0.0), Twist2(0.1, 0.0)),
        (Pose2(1.0, 0.0, 0.0), Twist2(0.0, -0.2)),
    ],
)
def test_a_goal_that_is_missed_or_passed_in_motion_is_not_reached(pose: Pose2, twist: Twist2) -> None:
    player = TrajectoryPlayer(PlayerSettings(goal_patience_s=1.0), line())
    play(player, 0, 1)
    for index in range(1, 600):
        assert player.update(odometry(GRID.stamp_ns(index), pose, twist)).reached is None
    assert player.phase is Phase.NOT_REACHED


def test_a_late_arrival_still_counts() -> None:
    player = TrajectoryPlayer(PlayerSettings(goal_patience_s=0.5), line())
    play(player, 0, 600)
    assert player.phase is Phase.NOT_REACHED
    assert any(output.reached for output in play(player, 600, 660, Pose2(1.0, 0.0, 0.0)))


def test_going_through_the_goal_is_not_resting_there() -> None:
    player = TrajectoryPlayer(PlayerSettings(rest_time_s=0.5), line())
    play(player, 0, 480)
    for index in range(480, 600):
        pose = Pose2(1.0 if index % 20 else 0.5, 0.0, 0.0)
        assert player.update(odometry(GRID.stamp_ns(index), pose)).reached is None


def test_loop_starts_over_without_a_jump() -> None:
    closed = make_reference(load_robot(), ReferenceSettings(), ShapeSettings(shape="circle", radius_m=0.5))
    player = TrajectoryPlayer(PlayerSettings(loop=True), closed)
    found = pieces(play(player, 0, 60 * 30))
    ends = np.array([piece.states[0, :2] for piece in found])
    assert np.max(np.hypot(*np.diff(ends, axis=0).T)) < 0.2 * 0.36
    assert all(output.reached is None for output in play(player, 1800, 1900))
    assert np.any(found[-1].inputs[:, 0] > 0.1)


def test_loop_of_an_open_trajectory_is_refused() -> None:
    with pytest.raises(ValueError, match="line ends 1 m"):
        TrajectoryPlayer(PlayerSettings(loop=True), line())


def test_reset_clock_starts_the_trajectory_over() -> None:
    player = TrajectoryPlayer(PlayerSettings(), line())
    play(player, 600, 900)
    piece = player.update(odometry(1_000_000_000, Pose2(5.0, 0.0, 0.0))).reference
    assert piece is not None and piece.stamp_ns == 1_000_000_000
    assert player.goal is not None and player.goal.x_m == pytest.approx(6.0)


def test_reordered_and_repeated_odometry_is_ignored_and_counted() -> None:
    player = TrajectoryPlayer(PlayerSettings(), line())
    play(player, 600, 630)
    assert player.update(odometry(GRID.stamp_ns(629))) == PlayerOutput()
    assert player.update(odometry(GRID.stamp_ns(620))) == PlayerOutput()
    assert player.ignored_odometry == 2


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_odometry_that_is_not_finite_is_ignored(bad: float) -> None:
    player = TrajectoryPlayer(PlayerSettings(), line())
    assert player.update(odometry(0, Pose2(bad, 0.0, 0.0))) == PlayerOutput()
    assert player.phase is Phase.WAITING and player.ignored_odometry == 1


def test_progress_goes_from_zero_to_one() -> None:
    player = TrajectoryPlayer(PlayerSettings(), line())
    assert player.progress == 0.0
    play(player, 0, 200)
    assert 0.2 < player.progress < 1.0
    play(player, 200, 600)
    assert player.progress == 1.0


def test_spacing_beyond_the_horizon_is_refused() -> None:
    with pytest.raises(ValueError, match="spacing_s"):
        PlayerSettings(horizon_s=0.5, spacing_s=0.9)
