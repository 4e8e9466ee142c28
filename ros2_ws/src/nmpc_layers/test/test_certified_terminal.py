import json
import shutil

import numpy as np
import pytest
import yaml

from nmpc_layers import UpperLayer, UpperSettings
from nmpc_layers.design_terminal import main as design_terminal
from nmpc_layers.layer_weights import weights_folder
from tracked_types.checked_yaml import CheckedFileError


@pytest.fixture
def own_weights(tmp_path):
    """A copy of the packaged weights and of the design beside them; a changed content may be written to it."""

    def write(change=lambda content: None):
        content = yaml.safe_load((weights_folder() / "weights.yaml").read_text())
        change(content)
        path = tmp_path / "weights.yaml"
        path.write_text(yaml.safe_dump(content))
        shutil.copy(weights_folder() / "upper_terminal.json", tmp_path)
        return path

    return write


def problem_of(layer, odometry, reference):
    problems = []
    solve = layer.solver.solve
    layer.solver.solve = lambda problem: problems.append(problem) or solve(problem)
    layer.set_reference(reference)
    layer.update(odometry)
    return problems[0]


def test_upper_layer_weighs_its_last_pose_by_the_packaged_design(robot, odometry_at, straight):
    layer = UpperLayer(UpperSettings.from_robot(robot))
    problem = problem_of(layer, odometry_at(1.0, x=0.3), straight(1.0))
    assert problem.terminal is layer.settings.certified.weight
    assert layer.settings.certified.level > 0.0


@pytest.mark.parametrize("speed", [0.1, 0.45, -0.3])
def test_reference_outside_the_proof_gets_the_scaled_weight(robot, odometry_at, straight, speed):
    layer = UpperLayer(UpperSettings.from_robot(robot))
    assert problem_of(layer, odometry_at(1.0, x=speed), straight(1.0, speed=speed)).terminal is None


def test_reference_that_turns_faster_than_proven_is_not_covered(robot):
    certified = UpperSettings.from_robot(robot).certified
    assert certified.covers(np.array([0.3, -0.6]))
    assert not certified.covers(np.array([0.3, 0.61]))
    assert not certified.covers(np.array([np.nan, 0.0]))


@pytest.mark.parametrize("tuning", [{"terminal": "scaled"}, {"layers": "single"}, {"method": "thesis"}])
def test_other_layers_keep_the_scaled_weight(robot, tuning):
    assert UpperSettings.from_robot(robot, **tuning).certified is None


def test_weights_that_name_no_design_are_scaled(robot, own_weights):
    path = own_weights(lambda content: content["improved"].pop("upper_terminal"))
    assert UpperSettings.from_robot(robot, weights_file=str(path)).certified is None


def test_design_beside_own_weights_is_used(robot, own_weights):
    settings = UpperSettings.from_robot(robot, weights_file=str(own_weights()))
    assert settings.certified == UpperSettings.from_robot(robot).certified


def changed(key, value):
    return lambda content: content["improved"]["upper"].update({key: value})


@pytest.mark.parametrize("key", ["position", "heading", "speed", "yaw_rate"])
def test_design_for_other_weights_is_refused_with_a_way_out(robot, own_weights, key):
    with pytest.raises(CheckedFileError, match=r"upper_terminal\.json.*weights.*set terminal to scaled"):
        UpperSettings.from_robot(robot, weights_file=str(own_weights(changed(key, 3.3))))


def test_design_for_another_rate_is_refused(robot):
    with pytest.raises(CheckedFileError, match=r"another model.*0\.1 s"):
        UpperSettings.from_robot(robot, rate_hz=10)
    assert UpperSettings.from_robot(robot, rate_hz=10, terminal="scaled").certified is None


def test_design_for_a_robot_that_may_do_less_is_refused(robot):
    slower = robot.model_copy(update={"limits": robot.limits.model_copy(update={"yaw_rate_max_radps": 1.0})})
    with pytest.raises(CheckedFileError, match="limits of the commands"):
        UpperSettings.from_robot(slower)


def test_changed_digit_is_noticed_also_after_the_file_was_good(robot, own_weights, tmp_path):
    path = own_weights()
    UpperSettings.from_robot(robot, weights_file=str(path))
    design = tmp_path / "upper_terminal.json"
    content = json.loads(design.read_text())
    content["gains"]["P"][1][1] += 1e-9
    design.write_text(json.dumps(content))
    with pytest.raises(CheckedFileError, match="gains"):
        UpperSettings.from_robot(robot, weights_file=str(path))


@pytest.mark.parametrize(("text", "match"), [(None, "cannot be read"), ("", "cannot be read"), ("{}", "format")])
def test_file_that_is_no_design_is_named(robot, own_weights, tmp_path, text, match):
    path = own_weights()
    design = tmp_path / "upper_terminal.json"
    design.unlink()
    if text is not None:
        design.write_text(text)
    with pytest.raises(CheckedFileError, match=rf"upper_terminal\.json.*{match}"):
        UpperSettings.from_robot(robot, weights_file=str(path))


def test_references_at_rest_have_no_terminal_weight(robot, own_weights):
    path = own_weights(lambda content: content["improved"]["upper_terminal"].update(speed_mps=[0.0, 0.4]))
    with pytest.raises(CheckedFileError, match="no terminal weight exists at rest"):
        UpperSettings.from_robot(robot, weights_file=str(path))


def test_new_design_fits_what_it_was_made_for(robot, own_weights, capsys):
    path = own_weights(changed("heading", 4.0))
    assert design_terminal(["--weights-file", str(path), "--rate-hz", "10"]) == 0
    assert "level" in capsys.readouterr().out
    settings = UpperSettings.from_robot(robot, weights_file=str(path), rate_hz=10)
    assert settings.certified is not None


def test_packaged_design_is_what_the_tool_makes(robot, tmp_path):
    assert design_terminal(["--out", str(tmp_path)]) == 0
    made = json.loads((tmp_path / "upper_terminal.json").read_text())["gains"]["P"]
    assert np.array(made) == pytest.approx(UpperSettings.from_robot(robot).certified.weight.matrix, rel=1e-3, abs=0.1)


def test_design_that_does_not_exist_is_an_exit_code(own_weights, capsys):
    path = own_weights(lambda content: content["improved"]["upper_terminal"].update(yaw_rate_radps=2.0))
    assert design_terminal(["--weights-file", str(path)]) == 1
    assert "room" in capsys.readouterr().err
