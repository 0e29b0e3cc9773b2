"""The benchmark's compiled code: a folder of its own, named after its sources too."""

from pathlib import Path

from gearidae import compiled as own
from gearidae_bench import compiling, kinks


def test_the_benchmark_has_a_folder_of_its_own():
    assert own.cache_folder(compiling.SOURCES) != own.cache_folder()
    assert own.cache_folder(compiling.SOURCES).parent == own.cache_folder().parent
    assert (Path(kinks.__file__).parent,) == compiling.SOURCES


def test_every_compiled_function_of_the_benchmark_is_kept_there():
    folder = str(own.cache_folder(compiling.SOURCES))
    declared = [one for one in vars(kinks).values() if isinstance(one, own.Function)]
    mine = [one for one in declared if one.py_func.__module__ == kinks.__name__]
    assert {one.py_func.__name__ for one in mine} == {"arm", "begin_step", "dip_in_step", "watch"}
    assert all(one.cache_path.startswith(folder) for one in mine)
    others = [one for one in declared if one not in mine]
    assert others
    assert not any(one.cache_path.startswith(folder) for one in others)


def test_an_edited_source_changes_the_folder(tmp_path):
    source = tmp_path / "loop.py"
    names = set()
    for text in ("a = 1", "a = 2", "a = 1"):
        source.write_text(text)
        own.cache_folder.cache_clear()
        names.add(own.cache_folder((tmp_path,)).name)
    own.cache_folder.cache_clear()
    assert len(names) == 2
