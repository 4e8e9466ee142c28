import numpy as np
import pytest

from sim_bridge.floor_plan import floor_plan
from sim_bridge.world import load_world, packaged_worlds


@pytest.mark.parametrize("name", packaged_worlds())
def test_everything_in_a_packaged_world_is_on_its_plan(name):
    world = load_world(name)
    plan = floor_plan(world)
    assert len(plan) == len(world.friction_zones) + len(list(world.solids()))
    assert all(np.isfinite(outline.points).all() for outline in plan)


def test_the_step_lies_where_the_world_puts_it_and_says_its_height():
    step = next(outline for outline in floor_plan(load_world("step")) if outline.kind == "step")
    corners = np.array(step.points)
    assert (corners[:, 0].min(), corners[:, 0].max()) == pytest.approx((1.5, 1.9))
    assert step.label == "step, 40 mm"
