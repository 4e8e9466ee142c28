from nmpc_layers import warm_up


def test_every_default_solver_is_built_and_named(capsys):
    assert warm_up.main() == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == len(warm_up.default_solvers())
    assert all("ready" in line for line in lines)


def test_without_a_compiler_set_up_is_told(capsys, monkeypatch, tmp_path):
    monkeypatch.setenv("TRACKED_CACHE_DIR", str(tmp_path))
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("CC", raising=False)
    assert warm_up.main() == 1
    assert "no C compiler" in capsys.readouterr().out
