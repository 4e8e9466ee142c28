import pytest

from nmpc_layers import LowerSettings, UpperSettings, load_weights
from nmpc_layers.solver import Weights
from tracked_types.checked_yaml import CheckedFileError

GOOD = "{position: 20, heading: 2, speed: 1, yaw_rate: 0.5, terminal: 5}"
METHOD = "{single: %s, upper: %s, lower: %s}"


def weights_file(tmp_path, text):
    path = tmp_path / "weights.yaml"
    path.write_text(text)
    return path


def full(replacement=GOOD):
    method = METHOD % (GOOD, GOOD, GOOD)
    return f"improved: {METHOD % (GOOD, GOOD, replacement)}\nthesis: {method}\n"


def test_packaged_weights_serve_both_methods():
    weights = load_weights()
    assert weights.of("improved").lower != weights.of("thesis").lower or weights.of("thesis").upper


def test_unknown_method_is_refused_with_the_known_ones():
    with pytest.raises(ValueError, match="improved, thesis"):
        load_weights().of("printed")


def test_file_of_the_user_is_used(tmp_path, robot):
    path = weights_file(tmp_path, full("{position: 7, heading: 2, speed: 1, yaw_rate: 0.5, terminal: 5}"))
    assert LowerSettings.from_robot(robot, weights_file=str(path)).weights.position == 7.0


@pytest.mark.parametrize(
    ("entry", "key"),
    [
        ("{position: -1, heading: 2, speed: 1, yaw_rate: 0.5, terminal: 5}", "position"),
        ("{position: 20, heading: .nan, speed: 1, yaw_rate: 0.5, terminal: 5}", "heading"),
        ("{position: 20, heading: 2, speed: 0, yaw_rate: 0.5, terminal: 5}", "speed"),
        ("{position: 20, heading: 2, speed: 1, yaw_rate: .inf, terminal: 5}", "yaw_rate"),
        ("{position: 20, heading: 2, speed: 1, yaw_rate: 0.5}", "terminal"),
        ("{position: 20, heading: 2, speed: 1, yaw_rate: 0.5, terminal: 5, jerk: 1}", "jerk"),
        ("{position: fast, heading: 2, speed: 1, yaw_rate: 0.5, terminal: 5}", "position"),
    ],
)
def test_bad_weight_is_named(tmp_path, entry, key):
    with pytest.raises(CheckedFileError, match=rf"improved\.lower.*{key}"):
        load_weights(weights_file(tmp_path, full(entry)))


@pytest.mark.parametrize("text", ["", "improved: 3", "[1, 2]", "improved: {", full() + "extra: 1\n"])
def test_file_of_another_shape_is_refused(tmp_path, text):
    with pytest.raises(CheckedFileError):
        load_weights(weights_file(tmp_path, text))


def test_missing_file_is_named(tmp_path):
    with pytest.raises(CheckedFileError, match="nowhere"):
        load_weights(tmp_path / "nowhere.yaml")


def test_layers_take_the_weights_of_their_role(robot):
    weights = load_weights().improved
    assert UpperSettings.from_robot(robot).weights == weights.upper
    assert UpperSettings.from_robot(robot, layers="single").weights == weights.single
    assert LowerSettings.from_robot(robot).weights == weights.lower


def test_weights_refuse_by_name():
    with pytest.raises(ValueError, match="terminal"):
        Weights(position=1.0, heading=1.0, speed=1.0, yaw_rate=1.0, terminal=0.0)


@pytest.mark.parametrize(
    ("settings", "tuning"),
    [
        (UpperSettings, {"method": "printed"}),
        (UpperSettings, {"layers": "triple"}),
        (UpperSettings, {"rate_hz": 7}),
        (UpperSettings, {"pipeline_latency_s": float("nan")}),
        (LowerSettings, {"horizon": 1}),
        (LowerSettings, {"plan_timeout_s": 0.25}),
        (LowerSettings, {"slip_compensation": 1}),
    ],
)
def test_bad_setting_is_named(robot, settings, tuning):
    with pytest.raises(ValueError, match=next(iter(tuning))):
        settings.from_robot(robot, **tuning)
