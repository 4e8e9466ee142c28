"""Where compiled code is kept, and that it is not needed to be kept anywhere."""

from sim_bridge import compiled as module


def test_cache_is_named_after_the_sources_below_the_directory_asked_for(monkeypatch, tmp_path):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert module.cache_directory() == tmp_path / f"sim_bridge-{module.source_hash()}"


def test_cache_goes_to_the_users_directory_otherwise(monkeypatch, tmp_path):
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert module.cache_directory().is_relative_to(tmp_path)


def test_changed_source_gets_another_name(monkeypatch, tmp_path):
    before = module.source_hash()
    plant = tmp_path / "x_structure.py"
    plant.write_text("# another law")
    monkeypatch.setattr(module.x_structure, "__file__", str(plant))
    assert module.source_hash() != before


def test_function_is_compiled_without_a_directory_to_keep_it_in(monkeypatch):
    def no_place(*args, **kwargs):
        if kwargs.get("cache"):
            raise RuntimeError("cannot cache function: no locator available")
        return real(*args, **kwargs)

    real = module.numba.njit
    monkeypatch.setattr(module.numba, "njit", no_place)
    assert module.compiled(lambda x: x + 1.0)(2.0) == 3.0
