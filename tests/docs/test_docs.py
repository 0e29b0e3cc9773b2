"""The documentation does what it says: every code block is run, page by page, and what it prints is compared."""

from __future__ import annotations

import importlib
import re
import shlex
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import gearidae as gd
from gearidae.cli import main
from gearidae.scene import describe_keys

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
CASES = ROOT / "cases"
PAGES = sorted(
    path.relative_to(ROOT) for path in (*DOCS.glob("*.md"), *DOCS.glob("reference/*.md"), ROOT / "README.md")
)

# Commands that a test cannot or should not run: they install, need other machines, or take minutes.
NOT_RUN = re.compile(r"^(?!gearidae )|--install-completion|^gearidae (bench|assess|coating-map)\b|--dask")


@dataclass(frozen=True)
class Block:
    language: str
    text: str
    line: int


def blocks(page: Path) -> Iterator[Block]:
    """The fenced blocks of a page, directives left out."""
    language, inside, begins = "", [], 0
    for number, line in enumerate((ROOT / page).read_text(encoding="utf-8").splitlines(), 1):
        fence = re.match(r"^(```+)\s*(\S*)", line)
        if fence and not begins:
            language, inside, begins = fence[2], [], number
        elif fence and line.strip() == "```":
            yield Block(language, "\n".join(inside) + "\n", begins)
            begins = 0
        elif begins:
            inside.append(line)
    assert not begins, f"{page}: a block is not closed"


def commands(text: str) -> Iterator[tuple[str, list[str]]]:
    """The commands of a console block, after a ``$`` or beginning with gearidae, each with its output below."""
    prompt = "$ " if text.startswith("$ ") else ""
    command, printed = "", []
    for line in text.splitlines():
        if line.startswith(prompt or "gearidae "):
            if command:
                yield command, printed
            command, printed = line.removeprefix(prompt).partition("  #")[0].strip(), []
        elif command and line.strip():
            printed.append(line)
    if command:
        yield command, printed


def same(shown: str, actual: str) -> bool:
    """Whether a line of the docs is (the beginning of) a printed one.

    Words must agree; numbers to 2 %, which is what a shown number of two digits allows. The wall time, last of a
    row of outcomes, is another on each machine.
    """
    wanted, printed = shown.split(), actual.split()
    if len(wanted) > len(printed):
        return False
    pairs = list(zip(wanted, printed, strict=False))
    if re.search(r"\s\d+\s+[\d.]+ [mu]?s$", shown):  # impacts, wall time
        pairs = pairs[:-2]
    return all(_same_word(*pair) for pair in pairs)


def _same_word(wanted: str, printed: str) -> bool:
    try:
        return bool(np.isclose(float(wanted), float(printed), rtol=0.02, atol=0.0))
    except ValueError:
        return wanted == printed


def prepare(page: Path) -> dict[str, object]:
    """What a page presupposes besides the case files: most begin from nothing."""
    if page.name != "assess.md":
        return {}
    scene = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 0.15, "run.samples": 15001})
    run = gd.simulate(scene.replace({"coating.sam_fraction": 0.629}))
    table = np.column_stack([run.time, run.gear_speed])
    np.savetxt("rig.csv", table, delimiter=",", header="time [s], gear_speed [rad/s]", comments="")
    return {"gd": gd, "scene": scene}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder as a reader has it: the case files, and a place to write."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cases").symlink_to(CASES)
    return tmp_path


def runnable(page: Path) -> bool:
    return any(
        block.language == "python"
        or (
            block.language == "console"
            and any(not NOT_RUN.search(command) for command, _ in commands(block.text))
        )
        for block in blocks(page)
    )


@pytest.mark.parametrize("page", [pytest.param(page, id=page.stem) for page in PAGES if runnable(page)])
def test_page_works_as_printed(page, folder, capfd):
    names = {"__name__": "__docs__", **prepare(page)}
    for block in blocks(page):
        if block.language == "python":
            # Padded, so that a failure names the line of the page.
            code = compile("\n" * block.line + block.text, str(page), "exec", dont_inherit=True)
            exec(code, names)
        elif block.language == "console":
            for command, printed in commands(block.text):
                if not NOT_RUN.search(command):
                    run_command(command, printed, f"{page}:{block.line}", capfd)


def run_command(command, printed, where, capfd):
    capfd.readouterr()
    code = main(shlex.split(command)[1:])
    out, err = capfd.readouterr()
    refused = any(line.startswith("gearidae: ") for line in printed)
    assert code == (2 if refused else 0), f"{where}: {command}: exit code {code}: {err}"
    lines = (out + err).splitlines()
    for shown in printed:
        assert any(same(shown, line) for line in lines), (
            f"{where}: {command}: does not print {shown!r}\n{out}"
        )


def test_every_link_between_pages_leads_somewhere():
    # the changelog is shown as a page of docs: its links have to lead somewhere from there, too
    changelog = DOCS / "changelog.md"
    for page in DOCS.rglob("*.md"):
        if "generated" in page.parts or "_build" in page.parts:
            continue
        shown = ROOT / "CHANGELOG.md" if page == changelog else page
        text = re.sub(r"```.*?```", "", shown.read_text(encoding="utf-8"), flags=re.DOTALL)
        for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text):
            assert (page.parent / target).exists(), f"{page.name}: {target}"


def test_generated_tables_are_complete(monkeypatch):
    monkeypatch.syspath_prepend(str(DOCS))
    generate = importlib.import_module("generate")
    keys, dataset, program = generate.key_table(), generate.dataset_tables(), generate.command_tables()
    for info in describe_keys():
        assert f"`{info.key}`" in keys
    for name in ("gear_speed", "event_gap_rate", "wall_time", "full_stretch", "coast"):
        assert f"`{name}`" in dataset
    for option in ("--over", "--jobs", "--map", "--quiet", "--log"):
        assert f"`{option}`" in program
    assert "--no-" not in program
    written = generate.study_tables()
    for words in (
        "Sticking threshold: `gearidae threshold`",
        "`passages_to_sticking`",
        "sticking limit of the key",
    ):
        assert words in written
    kept = generate.state_tables()
    for record in ("STATE", "HISTORY", "ENERGY", "PROGRESS"):
        assert f"## `{record}`" in kept
    assert "`state.energy.drive_work`" in kept
    sys.modules.pop("generate", None)
