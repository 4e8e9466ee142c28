"""The set-up's steps: what makes one stale, and that nothing half-done is trusted."""

import json
import os
import re
from pathlib import Path

import pytest

from tools.setup import caches, cmake_exports, commands, transform_messages, workspace
from tools.setup.layout import Layout
from tools.setup.problem import SetupProblem
from tools.setup.stamp import Stamp
from tools.setup.steps import stamped


class TestStampedStep:
    def test_a_step_is_current_only_after_it_succeeded(self, tmp_path):
        step = stamped("a step", Stamp(tmp_path / "stamp"), lambda: "inputs", lambda: None)
        assert not step.is_current()
        step.make()
        assert step.is_current()

    def test_an_interrupted_renewal_is_not_trusted(self, tmp_path):
        stamp = Stamp(tmp_path / "stamp")
        stamp.write("inputs")

        def interrupted() -> None:
            raise KeyboardInterrupt

        step = stamped("a step", stamp, lambda: "inputs", interrupted)
        with pytest.raises(KeyboardInterrupt):
            step.make()
        assert not step.is_current()

    def test_deleting_the_product_deletes_the_proof(self, tmp_path):
        product = tmp_path / "product"
        step = stamped("a step", Stamp(product / "stamp"), lambda: "inputs", lambda: None)
        step.make()
        (product / "stamp").unlink()
        product.rmdir()
        assert not step.is_current()

    def test_inputs_that_change_while_it_runs_make_it_stale(self, tmp_path):
        inputs = ["before"]
        step = stamped("a step", Stamp(tmp_path / "stamp"), lambda: inputs[-1], lambda: inputs.append("after"))
        step.make()
        assert not step.is_current()


class TestExternalCommand:
    @pytest.mark.parametrize(
        ("output", "sentence"),
        [
            ("error: Failed to fetch: `x`\n  Caused by: dns error: Name or service not known", "cannot be reached"),
            ("ERROR: Could not find a version that satisfies uv==1 (from versions: none)", "cannot be reached"),
            ("cc1: fatal error: /tmp/x.s: No space left on device", "disk is full"),
            ("OSError: [Errno 30] Read-only file system: 'x'", "read-only"),
            ("error: Hash mismatch for `x==1`", "differs from the locked one"),
        ],
    )
    def test_a_known_cause_is_told_in_one_sentence(self, output, sentence):
        explained = commands.explain(output)
        assert explained is not None
        assert sentence in explained
        assert "`make setup`" in explained

    def test_an_unknown_cause_is_told_with_the_end_of_the_log(self, tmp_path):
        with pytest.raises(SetupProblem, match=r"Doing it failed: read the end of .*log.*\n.*no such luck"):
            commands.run_logged(["sh", "-c", "echo no such luck; exit 3"], log=tmp_path / "log", doing="Doing it")
        assert "no such luck" in (tmp_path / "log").read_text()

    def test_a_command_that_does_not_exist_is_a_problem_not_a_traceback(self, tmp_path):
        with pytest.raises(SetupProblem, match="could not start"):
            commands.run_logged(["/no/such/program"], log=tmp_path / "log", doing="Doing it")

    def test_only_the_lines_asked_for_are_shown(self, tmp_path, capsys):
        command = ["printf", "noise\nFinished <<< a\n"]
        commands.run_logged(command, log=tmp_path / "log", doing="Doing it", show=re.compile("^Finished"))
        assert capsys.readouterr().out.split() == ["Finished", "<<<", "a"]

    def test_a_sourced_ros_does_not_leak_in(self, monkeypatch):
        monkeypatch.setenv("AMENT_PREFIX_PATH", "/opt/ros/jazzy")
        monkeypatch.setenv("PYTHONPATH", "/opt/ros/jazzy/lib")
        assert not {"AMENT_PREFIX_PATH", "PYTHONPATH"} & set(commands.clean_environment())


class TestCmakeExports:
    FOREIGN = 'INTERFACE_INCLUDE_DIRECTORIES "{}/opt/python/include/python3.11;/b/numpy/_core/include;/keep/include"'

    def test_only_include_paths_of_python_and_numpy_are_replaced(self):
        text = cmake_exports.mended(self.FOREIGN, "/v/include/python3.11", "/v/numpy/_core/include")
        expected = '"/v/include/python3.11;/v/numpy/_core/include;/keep/include"'
        assert text == f"INTERFACE_INCLUDE_DIRECTORIES {expected}"
        assert cmake_exports.mended(text, "/v/include/python3.11", "/v/numpy/_core/include") == text

    def test_a_file_shared_with_the_cache_is_not_written_through(self, tmp_path):
        cached = tmp_path / "cached"
        cached.write_text("as downloaded")
        os.link(cached, tmp_path / "installed")
        cmake_exports.replace_file(tmp_path / "installed", "mended")
        assert cached.read_text() == "as downloaded"
        assert (tmp_path / "installed").read_text() == "mended"


class TestTransformMessages:
    def test_another_definition_than_the_official_one_is_refused(self, tmp_path):
        layout = Layout(tmp_path)
        description = layout.venv / "share" / "tf2_msgs" / "msg" / "TFMessage.json"
        description.parent.mkdir(parents=True)
        hashes = [{"type_name": "tf2_msgs/msg/TFMessage", "hash_string": "RIHS01_0"}]
        description.write_text(json.dumps({"type_hashes": hashes}))
        with pytest.raises(SetupProblem, match="git checkout tools/tf2_msgs"):
            transform_messages.check_type_hash(layout)


class TestWorkspace:
    @pytest.fixture
    def package(self, tmp_path: Path) -> Path:
        """A package with a module, a message and a data file."""
        package = tmp_path / "ros2_ws" / "src" / "crawler"
        for name in ("package.xml", "setup.py", "crawler/drive.py", "crawler/data/world.yaml", "msg/State.msg"):
            (package / name).parent.mkdir(parents=True, exist_ok=True)
            (package / name).write_text("one")
        return package

    @pytest.mark.parametrize("name", ["crawler/drive.py", "crawler/data/world.yaml", "crawler/new.py", "test/x.yaml"])
    def test_what_the_installation_links_needs_no_build(self, package, name):
        before = workspace.package_fingerprint(package, "base")
        (package / name).parent.mkdir(exist_ok=True)
        (package / name).write_text("two")
        assert workspace.package_fingerprint(package, "base") == before

    @pytest.mark.parametrize("name", ["package.xml", "setup.py", "msg/State.msg", "crawler/data/new.yaml"])
    def test_what_the_build_reads_makes_it_stale(self, package, name):
        before = workspace.package_fingerprint(package, "base")
        (package / name).write_text("two")
        assert workspace.package_fingerprint(package, "base") != before

    def test_a_new_environment_makes_every_package_stale(self, package):
        assert workspace.package_fingerprint(package, "a") != workspace.package_fingerprint(package, "b")

    def test_only_the_changed_package_is_built(self, package, tmp_path):
        layout = Layout(tmp_path)
        assert workspace.stale_packages(layout, "base") == ["crawler"]
        workspace.stamp_of(layout, "crawler").write(workspace.package_fingerprint(package, "base"))
        assert workspace.stale_packages(layout, "base") == []

    def test_the_installation_of_a_removed_package_is_an_orphan(self, package, tmp_path):
        layout = Layout(tmp_path)
        for name in ("crawler", "removed"):
            (layout.workspace / "install" / name).mkdir(parents=True)
        assert workspace.orphans(layout) == [layout.workspace / "install" / "removed"]


class TestCaches:
    @pytest.fixture
    def layout(self, tmp_path: Path) -> Layout:
        """A simulator that stands on a description and knows nothing of a report."""
        for package, dependency in (("sim_bridge", "description"), ("description", "numpy"), ("report", "description")):
            module = tmp_path / "ros2_ws" / "src" / package / package
            (module / "nodes").mkdir(parents=True)
            (module.parent / "package.xml").write_text(f"<package><exec_depend>{dependency}</exec_depend></package>")
            for name in ("warm_up.py", "data.yaml", "nodes/node.py"):
                (module / name).write_text(package)
        return Layout(tmp_path)

    def test_what_the_compiled_packages_stand_on_makes_them_stale(self, layout):
        names = {f"{file.parent.name}/{file.name}" for file in caches.inputs(layout)}
        assert names == {
            "sim_bridge/warm_up.py",
            "sim_bridge/data.yaml",
            "description/warm_up.py",
            "description/data.yaml",
        }

    def test_a_package_that_is_not_there_has_nothing_to_fill(self, tmp_path):
        assert caches.warm_up_files(Layout(tmp_path)) == []
        assert caches.inputs(Layout(tmp_path)) == []
