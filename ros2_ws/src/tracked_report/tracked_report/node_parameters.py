"""What a scenario means for each node: the one translation that the graph's bringup and the lab share."""

from tracked_report.scenario import Scenario, StartPose, Value


def node_parameters(scenario: Scenario, variant: str) -> dict[str, dict[str, Value]]:
    """Parameters of every node in one variant of ``scenario``: node name -> parameter name -> value.

    What the scenario says in its own words (world, layers, latency) comes first; parameters that it spells
    out for a node override it. Rate and latency of the plans are those of upper_nmpc, for all who count with them.

    Raises
    ------
    KeyError: for an unknown variant.
    """
    chosen = scenario.variants[variant]
    simulator: dict[str, Value] = {
        "world": scenario.world,
        "seed": scenario.seed,
        "time_mode": scenario.time,
    }
    if isinstance(scenario.start, StartPose):
        simulator["start"] = "pose"
        simulator["start_pose"] = [scenario.start.x_m, scenario.start.y_m, scenario.start.yaw_rad]
    else:
        simulator["start"] = scenario.start
    suspension = scenario.suspension_of(variant)
    if suspension is not None:
        simulator["suspension"] = suspension
    locked = scenario.time == "lock_step"
    spelled_out = scenario.parameters_of(variant)
    planner = spelled_out.get("upper_nmpc", {})
    rate_hz = planner.get("rate_hz", scenario.plan_rate_hz)
    latency_s = planner.get("pipeline_latency_s", scenario.pipeline_latency_s)
    parameters: dict[str, dict[str, Value]] = {
        "sim_bridge": simulator,
        "upper_nmpc": {
            "layers": chosen.layers,
            "method": chosen.method,
            "rate_hz": rate_hz,
            "pipeline_latency_s": latency_s,
        },
        "lower_nmpc": {
            "method": chosen.method,
            "plan_rate_hz": rate_hz,
            "pipeline_latency_s": latency_s,
            "lock_step": locked,
        },
    }
    if scenario.reference is not None:
        player: dict[str, Value] = {"rate_hz": rate_hz, **scenario.reference.parameters}
        if scenario.reference.shape is not None:
            player["shape"] = scenario.reference.shape
        if scenario.reference.file is not None:
            player["trajectory_file"] = scenario.reference.file
        parameters["trajectory_player"] = player
    for node, values in spelled_out.items():
        parameters.setdefault(node, {}).update(values)
    return parameters
