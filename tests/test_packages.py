"""Dependencies of the packages: who imports whom, read from the sources and never run."""

import ast
import subprocess
import sys
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

from gearidae.compiled.cache import COMPILED_PACKAGES

SOURCE = Path(__file__).parents[1] / "src" / "gearidae"
USES = ("monitor", "wear", "calibration", "surfaces")
"""What nobody needs to run gears: coating maps and assessments, lives, calibrations, height maps."""
SHOWS = ("plot", "report", "cli", "citing", "testing")
"""What shows the core and its uses."""
ANSWERS = ("studies._", "studies.declared.")
LOADED = "print(*sorted(name for name in sys.modules if name.startswith('gearidae.')))"
IMPORT = f"import sys, gearidae; {LOADED}"
RUN = """
import sys

from gearidae.cli import main

assert main(["run", "teodorescu2009_low_speed", "--set", "run.duration=1e-3", "-o", sys.argv[1]]) == 0
"""


def imported(path, package):
    """Modules below a package that a file imports, also inside functions; not what only type checkers read."""
    tree = ast.parse(path.read_text())
    for node in ast.walk(tree):
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            node.body = []
    prefix = f"{package}."
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.module:
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        else:
            continue
        yield from (name.removeprefix(prefix) for name in names if name.startswith(prefix))


def arrows(folder, package):
    """Packages within a package, each with those that it imports: folders, and modules beside the folders."""
    packages = {
        path.stem for path in folder.iterdir() if (path / "__init__.py").exists() or path.suffix == ".py"
    }
    imports = {name: set() for name in packages - {"__init__"}}
    for path in folder.rglob("*.py"):
        name = path.relative_to(folder).parts[0].removesuffix(".py")
        if name != "__init__":  # the public API, which shows names of upper packages
            others = {name.partition(".")[0] for name in imported(path, package)}
            imports[name] |= (others & packages) - {name, "__init__"}
    return imports


def test_no_arrow_between_packages_of_the_engine_runs_back():
    imports = arrows(SOURCE / "engine", "gearidae.engine")
    both_ways = sorted(
        {
            tuple(sorted((package, imported_package)))
            for package in imports
            for imported_package in imports[package]
            if package in imports[imported_package]
        }
    )
    assert both_ways == []
    order = list(TopologicalSorter(imports).static_order())
    place = {name: order.index(name) for name in order}
    assert place["model"] < place["motion"] < place["integrate"] < place["step"] < place["native"]
    assert place["motion"] < place["setup"] < place["native"]


def compiled_functions(tree):
    """Functions of a file that are declared to be compiled, and those that they contain."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            names = {ast.unparse(mark).partition("(")[0] for mark in node.decorator_list}
            if names & {"compiled", "compiled_once", "compiled_callback"}:
                yield node


def outside_the_hash(folder, package, inside):
    """Files with compiled functions, and files whose names compiled functions use, that are not in the hash."""
    files = {
        path.relative_to(folder).as_posix(): ast.parse(path.read_text()) for path in folder.rglob("*.py")
    }
    wanted = {file for file, tree in files.items() if any(True for _ in compiled_functions(tree))}
    for file in tuple(wanted):
        used = {
            name.id
            for function in compiled_functions(files[file])
            for statement in function.body
            for name in ast.walk(statement)
            if isinstance(name, ast.Name)
        }
        for node in ast.walk(files[file]):
            if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith(f"{package}."):
                place = node.module.removeprefix(f"{package}.").replace(".", "/")
                if any((alias.asname or alias.name) in used for alias in node.names):
                    wanted.add(f"{place}.py" if f"{place}.py" in files else f"{place}/__init__.py")
    return sorted(file for file in wanted if not file.startswith(tuple(inside)))


def test_all_that_is_compiled_is_in_the_hash_that_names_its_folder():
    """A file that were left out would run as it was before its last edit, without a word."""
    assert outside_the_hash(SOURCE, "gearidae", COMPILED_PACKAGES) == []
    without = [package for package in COMPILED_PACKAGES if package != "laws"]
    assert "laws/shaft/drag.py" in outside_the_hash(SOURCE, "gearidae", without)


def test_a_constant_of_compiled_code_from_elsewhere_would_be_found(tmp_path):
    (tmp_path / "limits.py").write_text("MOST = 3")
    (tmp_path / "words.py").write_text("TEXT = 'a'")
    (tmp_path / "laws.py").write_text(
        "from p.limits import MOST\nfrom p.words import TEXT\n@compiled(inline=True)\ndef f(x):\n    return x + MOST"
    )
    assert outside_the_hash(tmp_path, "p", ("laws",)) == ["limits.py"]


def test_no_two_packages_import_each_other():
    imports = arrows(SOURCE, "gearidae")
    assert [
        (package, imported_package)
        for package in imports
        for imported_package in imports[package]
        if package in imports[imported_package]
    ] == []


def test_a_circle_would_be_found(tmp_path):
    """Also one over three packages, and one through an import inside a function."""
    for name, text in (
        ("a", "import p.b.x"),
        ("b", "def f():\n    from p.c import y"),
        ("c", "from p.a import z"),
    ):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text(text)
    assert arrows(tmp_path, "p") == {"a": {"b"}, "b": {"c"}, "c": {"a"}}
    with pytest.raises(CycleError):
        TopologicalSorter(arrows(tmp_path, "p")).prepare()


def importers(folder, package, upper, above):
    """Files of the core that import a package of `upper`; those of `above` and public lists of names may."""
    found = []
    for path in folder.rglob("*.py"):
        home = path.relative_to(folder).parts[0].removesuffix(".py")
        if home in (*upper, *above) or (path.name == "__init__.py" and is_lazy(path)):
            continue
        found += [
            f"{path.relative_to(folder)}: {name}"
            for name in imported(path, package)
            if name.partition(".")[0] in upper
        ]
    return found


def is_lazy(path):
    """Whether a package only names what it loads on first use."""
    return "lazy_names(__name__" in path.read_text()


def test_the_core_imports_none_of_its_uses():
    """Nor does a file of one use import another: each can be left out without the others."""
    assert importers(SOURCE, "gearidae", USES, SHOWS) == []
    for use in USES:
        others = tuple(other for other in USES if other != use)
        assert importers(SOURCE / use, "gearidae", others, ()) == []


def test_an_import_of_a_use_would_be_found(tmp_path):
    """Also one inside a function; a public list of names and what shows the use may have it."""
    (tmp_path / "core.py").write_text("def f():\n    from p.use import x")
    (tmp_path / "show.py").write_text("from p.use import x")
    (tmp_path / "__init__.py").write_text("from p.use import x\nlazy_names(__name__)")
    assert importers(tmp_path, "p", ("use",), ("show",)) == ["core.py: use.x"]


def modules_of(program, *arguments):
    """Modules of the package that a process of its own has loaded."""
    command = [sys.executable, "-c", program, *arguments]
    lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.split("\n")
    return [name.removeprefix("gearidae.") for name in lines[-2].split()]


@pytest.mark.parametrize("program", [IMPORT, RUN + LOADED], ids=["import", "run"])
def test_neither_an_import_nor_a_run_loads_a_use_of_the_core(program, tmp_path):
    """As the command line runs it; what a run does need shows that the look sees modules."""
    loaded = modules_of(program, str(tmp_path / "run.nc"))
    if program != IMPORT:
        assert {"scene", "engine.backend", "runs.simulation"} <= set(loaded)
    assert [name for name in loaded if name.partition(".")[0] in (*USES, "plot", "report", "testing")] == []
    assert [name for name in loaded if name.startswith(ANSWERS)] == []
