"""Put faults into copies of the package, one at a time, and see that the tests catch them.

``python tests/mutants/run.py -o docs`` tries all of the catalogue, in half an hour, and writes ``docs/mutants.md``.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from datetime import UTC, datetime
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from mutants.catalogue import MUTANTS, Mutant

ROOT = Path(__file__).parents[2]
_INTRODUCTION = """\
After this page you know which small faults in the code the tests detect, and which test detects each of them.
Each row is one fault put into a copy of the package, such as a wrong constant, a missing update of the history or a
wrong sign. The tests named in the catalogue (`tests/mutants/catalogue.py`) are run on this copy, and the table gives
the first test that fails. A fault that no test detects would be listed as not caught. Three of the faults are tried in
every run of the test suite."""
TESTS_FAILED = 1  # pytest's exit code; others mean that the tests could not be run


def make(mutant: Mutant, folder: Path) -> None:
    """Copy the package into a folder, with the fault in it."""
    shutil.copytree(ROOT / "src", folder / "src", ignore=shutil.ignore_patterns("__pycache__"))
    path = folder / "src" / "gearidae" / mutant.file
    text = path.read_text()
    if text.count(mutant.old) != 1:
        raise ValueError(f"{mutant.file} has {mutant.old!r} {text.count(mutant.old)} times, not once")
    path.write_text(text.replace(mutant.old, mutant.new))


def catch(mutant: Mutant, *, compiled: bool = True) -> str:
    """Return the first test that a mutant fails, or why there is none."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        make(mutant, folder)
        environment = os.environ | {"PYTHONPATH": str(folder / "src"), "NUMBA_CACHE_DIR": name}
        if not compiled:
            environment["NUMBA_DISABLE_JIT"] = "1"
        command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "-p", "no:randomly"]
        command += [f"tests/{test}" for test in mutant.tests]
        run = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    failed = re.search(r"^FAILED tests/(.*?)(?: - |$)", run.stdout, re.MULTILINE)
    if run.returncode == TESTS_FAILED and failed:
        return failed[1]
    return "not caught" if run.returncode == 0 else f"could not be tested: {run.stdout[-300:]}"


def page(results: dict[str, str]) -> str:
    """Write what was caught by what, in Markdown."""
    survivors = [what for what, test in results.items() if "::" not in test]
    lines = [
        "# Faults that the tests catch",
        "",
        f"`python tests/mutants/run.py -o docs` on {datetime.now(UTC).date().isoformat()}.",
        "",
        _INTRODUCTION,
        "",
        f"**{len(results)} faults, {len(survivors)} not caught.**",
        "",
        "| fault | caught by |",
        "|---|---|",
        *(f"| {what} | `{test}` |" for what, test in results.items()),
        "",
    ]
    return "\n".join(lines)


def main() -> int:
    """Try all mutants, or those whose description contains a word."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, help="folder for mutants.md")
    parser.add_argument("--only", default="", help="those with this in their description")
    chosen = parser.parse_args()
    results = {}
    for mutant in MUTANTS:
        if chosen.only in mutant.what:
            results[mutant.what] = catch(mutant)
            sys.stdout.write(f"{mutant.what}: {results[mutant.what]}\n")
            sys.stdout.flush()
    if chosen.output is not None:
        (chosen.output / "mutants.md").write_text(page(results))
    return int(any("::" not in test for test in results.values()))


if __name__ == "__main__":
    sys.exit(main())
