from tracked_bringup.node_table import load_node_table
from tracked_bringup.run_meta import run_meta
from tracked_bringup.scenarios import load_scenario


def test_a_record_says_what_was_run_and_what_the_world_looks_like() -> None:
    meta = run_meta(load_scenario("compare", [], load_node_table()), "single", simulated=True)
    assert (meta.scenario, meta.variant, meta.world, meta.suspension) == ("demo", "single", "step", "qzs")
    assert meta.pipeline_latency_s == 0.1 and meta.limits is not None
    assert any(outline.kind == "step" for outline in meta.scene)


def test_without_a_simulator_there_is_no_scene() -> None:
    assert run_meta(load_scenario("track", [], load_node_table()), "double", simulated=False).scene == ()
