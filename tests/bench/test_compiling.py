"""The benchmark's compiled code: a folder of its own, named after its sources too."""

from pathlib import Path

from gearidae import compiled
from gearidae_bench import compiling, kinks


def test_the_benchmark_has_a_folder_of_its_own():
    assert compiled.cache_folder(compiling.SOURCES) != compiled.cache_folder()
    assert compiled.cache_folder(compiling.SOURCES).parent == compiled.cache_folder().parent
    assert (Path(kinks.__file__).parent,) == compiling.SOURCES


def test_every_compiled_function_of_the_benchmark_is_kept_there():
    folder = str(compiled.cache_folder(compiling.SOURCES))
    declared = [function for function in vars(kinks).values() if isinstance(function, compiled.Function)]
    mine = [function for function in declared if function.py_func.__module__ == kinks.__name__]
    assert {function.py_func.__name__ for function in mine} == {"arm", "begin_step", "dip_in_step", "watch"}
    assert all(function.cache_path.startswith(folder) for function in mine)
    others = [function for function in declared if function not in mine]
    assert others
    assert not any(function.cache_path.startswith(folder) for function in others)


def test_an_edited_source_changes_the_folder(tmp_path):
    source = tmp_path / "loop.py"
    names = set()
    for text in ("a = 1", "a = 2", "a = 1"):
        source.write_text(text)
        compiled.cache_folder.cache_clear()
        names.add(compiled.cache_folder((tmp_path,)).name)
    compiled.cache_folder.cache_clear()
    assert len(names) == 2
