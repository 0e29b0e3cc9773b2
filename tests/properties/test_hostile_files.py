"""Mutated case files, archives and signals: a clean error that names the file or key, or a valid scene; never more."""

import contextlib
import random
import shutil
import sqlite3
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import gearidae as gd
from gearidae.archive import open_archive, unfinished
from gearidae.archive.journal import Journal, journal_of
from gearidae.cli import main
from gearidae.engine import portable
from gearidae.errors import SceneError
from gearidae.monitor.measured import read_signal
from gearidae.scene import Scene, dump_case

CASES = sorted((Path(__file__).parents[2] / "cases").glob("*.toml"))
PIECES = [
    "[",
    "]",
    "=",
    '"',
    "'",
    "\n",
    "nan",
    "-inf",
    "1e999",
    "{",
    "}",
    ",",
    "9" * 400,
    "\x00",
    "\ufeff",
    "true",
    "[[a]]",
]
PIECES += ["1_000", "0x10", "2026-01-01", "nm", "..", "[gears]", "samples = 0.5", "é", '"""', "load = 3", "-"]
FOLDER_IS_SHARED = [
    HealthCheck.function_scoped_fixture
]  # every example writes its own content to the one file


def attempt(read, file):
    """What was read, or None and the message of the only error allowed."""
    try:
        return read(file), ""
    except SceneError as error:
        return None, str(error)


edits = st.lists(
    st.tuples(st.floats(0.0, 1.0), st.integers(0, 12), st.sampled_from(PIECES) | st.text(max_size=4)),
    min_size=1,
    max_size=4,
)


@settings(max_examples=150, suppress_health_check=FOLDER_IS_SHARED)
@given(case=st.sampled_from(CASES), changes=edits)
def test_a_mutated_case_file_is_a_scene_or_a_clean_error(tmp_path, case, changes):
    text = case.read_text()
    for place, removed, put in changes:
        at = int(place * len(text))
        text = text[:at] + put + text[at + removed :]
    file = tmp_path / "case.toml"
    file.write_bytes(text.encode("utf-8", "surrogatepass"))
    scene, refusal = attempt(gd.load_case, file)
    assert "\n" not in refusal
    assert len(refusal) < 2000
    assert scene is None or Scene.from_dict(scene.to_dict()) == scene
    assert [path.name for path in tmp_path.iterdir()] == ["case.toml"]


@pytest.fixture(scope="module")
def archive(tmp_path_factory):
    file = tmp_path_factory.mktemp("archive") / "run.nc"
    gd.simulate(gd.preset("roller_slow").replace({"run.samples": 51}), archive=file)
    return file.read_bytes()


@settings(max_examples=60, suppress_health_check=FOLDER_IS_SHARED)
@given(
    share=st.floats(0.0, 1.0),
    flips=st.lists(st.tuples(st.floats(0.0, 1.0, exclude_max=True), st.integers(1, 255)), max_size=6),
)
def test_a_damaged_archive_is_read_or_refused(tmp_path, archive, share, flips):
    content = bytearray(archive if share > 0.5 else archive[: int(2 * share * len(archive))])
    for place, mask in flips:
        if content:
            content[int(place * len(content))] ^= mask
    file = tmp_path / "run.nc"
    file.write_bytes(bytes(content))
    ds, refusal = attempt(open_archive, file)
    assert "run.nc" in refusal if ds is None else {"time", "height", "event_time"} <= set(ds.variables)
    assert file.read_bytes() == bytes(content)
    assert [path.name for path in tmp_path.iterdir()] == ["run.nc"]


def _foreign(tmp_path, kind):
    file = tmp_path / "foreign.nc"
    if kind == "netcdf":
        xr.Dataset({"temperature": ("time", np.arange(3.0))}).to_netcdf(file)
    elif kind == "classic":
        xr.Dataset({"time": ("time", np.arange(3.0))}).to_netcdf(file, engine="scipy")
    elif kind == "sqlite":
        with sqlite3.connect(file) as connection:
            connection.execute("create table t (a)")
        connection.close()
    elif kind == "empty":
        file.touch()
    else:
        file.write_text("time [s], gear_speed [rad/s]\n")
    return file


@pytest.mark.parametrize("kind", ["netcdf", "classic", "sqlite", "empty", "text"])
def test_a_foreign_file_is_no_archive(tmp_path, kind):
    with pytest.raises(SceneError, match=r"foreign\.nc"):
        open_archive(_foreign(tmp_path, kind))


@pytest.mark.parametrize("version", [0, -1, 999, "1; import os", 1.5])
def test_another_schema_version_is_refused(tmp_path, version):
    file = tmp_path / "run.nc"
    ds = gd.simulate(gd.preset("roller_slow").replace({"run.samples": 5}))
    ds.attrs["schema_version"] = version
    ds.to_netcdf(file)
    with pytest.raises(SceneError, match="schema_version"):
        open_archive(file)


LINES = ["time [s], gear_speed [rad/s]"] + [f"{i * 1e-4:.6g}, {1.5 + 0.01 * (i % 7)}" for i in range(40)]


@settings(max_examples=120, suppress_health_check=FOLDER_IS_SHARED)
@given(
    row=st.integers(0, 40),
    put=st.sampled_from(["", "nan, 1", "1e999, 2", "a, b", "1", "0, 0", "#", ",,,", "1;2", "\t", "-1, 3"])
    | st.text(max_size=12),
    keep=st.booleans(),
)
def test_a_mutated_signal_is_read_or_refused(tmp_path, row, put, keep):
    lines = [*LINES[:row], put, *LINES[row if keep else row + 1 :]]
    file = tmp_path / "signal.csv"
    file.write_bytes("\n".join(lines).encode("utf-8", "surrogatepass"))
    ds, refusal = attempt(read_signal, file)
    assert "\n" not in refusal
    assert ds is None or (np.isfinite(ds["gear_speed"]).all() and (np.diff(ds["time"]) > 0).all())
    assert [path.name for path in tmp_path.iterdir()] == ["signal.csv"]


# -- what the journal of a run holds, through the commands that read one ---------------------------------------------

PARTIAL = gd.preset("teodorescu2009_low_speed").replace({"run.duration": "3 ms", "run.samples": 101})
NAMED_ENDINGS = (0, 2, 3)
ATTRIBUTES = ("title", "scene", "status", "backend", "schema_version", "rtol")
VALUES = ("x" * 200_000, "[" * 5000, np.arange(3.0), 2**62, float("nan"), "\x1b[31mred\nline")


class _CutOffError(Exception):
    """What ends a run in the middle, as a kill would."""


@pytest.fixture(scope="module")
def partial(tmp_path_factory):
    """The archive of a run that was cut off behind its first checkpoints.

    The portable driver wrote it: its limits are not compiled in, and can be lowered here.
    """
    file = tmp_path_factory.mktemp("partial") / "partial.nc"

    def cut(time, events):
        if time > 0.5 * PARTIAL.run.duration:
            raise _CutOffError

    with many_checkpoints(), pytest.raises(_CutOffError):
        gd.simulate(PARTIAL, archive=file, backend="sksundae", progress=cut)
    assert "checkpoint at" in open_archive(file).attrs["message"]
    return file


@contextlib.contextmanager
def many_checkpoints():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(portable, "CHECKPOINT_STEPS", 100)
        patch.setattr(unfinished, "CHECKPOINT_SECONDS", 0.0)
        patch.setattr(unfinished, "CHECKPOINT_SHARE", 0.0)
        yield


@pytest.fixture(scope="module")
def whole():
    """The same run, not cut off."""
    with many_checkpoints():
        return gd.simulate(PARTIAL, backend="sksundae")


def copied(partial, folder):
    """Name of an archive of which the journal is there, for a test to change."""
    file = folder / partial.name
    shutil.copyfile(journal_of(partial), journal_of(file))
    return file


@pytest.fixture(scope="module")
def partial_case(tmp_path_factory):
    file = tmp_path_factory.mktemp("partial_case") / "partial.toml"
    file.write_text(dump_case(PARTIAL))
    return file


def read_by_commands(file, case, folder, capsys, *, pictures=True):
    """Let commands read the file; each ends with an exit code of its own, and complains in one line if it does.

    Plots and reports take a second each, and are not always made.
    """
    commands = {
        "info": ["info", str(file)],
        "plot": ["plot", str(file), "-o", str(folder / "p.png"), "--overwrite"],
        "report": ["report", str(file), "-o", str(folder / "p.html"), "--overwrite"],
        "resume": ["run", str(case), "-o", str(file), "--resume", "--quiet"],
    }
    for name, arguments in commands.items():
        if name in ("plot", "report") and not pictures:
            continue
        code = main(arguments)
        said = capsys.readouterr().err
        assert code in NAMED_ENDINGS, f"{name}: exit code {code}, {said}"
        if code != 0:
            # that a damaged part is left out is said beside it
            lines = [line for line in said.strip().splitlines() if "is left out" not in line]
            assert len(lines) == 1, f"{name}: {said[:500]}"
        assert "Traceback" not in said


@pytest.mark.parametrize("seed", range(8))
def test_a_damaged_partial_archive_ends_in_one_line(tmp_path, partial, partial_case, capsys, seed):
    """Flipped bits anywhere, and ends cut off."""
    rng = random.Random(seed)
    content = bytearray(journal_of(partial).read_bytes())
    if rng.random() < 0.3:
        del content[rng.randrange(len(content)) :]
    for _ in range(rng.choice([1, 3, 30]) if content else 0):
        content[rng.randrange(len(content))] ^= 1 << rng.randrange(8)
    file = copied(partial, tmp_path)
    journal_of(file).write_bytes(content)
    read_by_commands(file, partial_case, tmp_path, capsys, pictures=seed % 4 == 0)


@pytest.mark.parametrize("seed", range(8))
def test_no_value_of_a_damaged_partial_archive_is_wrong_in_silence(tmp_path, partial, whole, seed):
    """Zeros and other bytes over up to a page, anywhere: refused, or the beginning of the run to the last bit."""
    rng = random.Random(f"values {seed}")
    content = bytearray(journal_of(partial).read_bytes())
    at = rng.randrange(len(content))
    length = min(rng.randrange(1, 4096), len(content) - at)
    content[at : at + length] = rng.randbytes(length) if seed % 2 else bytes(length)
    file = copied(partial, tmp_path)
    journal_of(file).write_bytes(content)
    part, _ = attempt(open_archive, file)
    for name in () if part is None else ("time", "gear_speed", "mesh_force", "event_time", "event_kind"):
        values = part[name].values[np.isfinite(part[name].values)]
        np.testing.assert_array_equal(values, whole[name].values[: values.size])
    with many_checkpoints():
        resumed, _ = attempt(
            lambda path: gd.simulate(PARTIAL, archive=path, backend="sksundae", resume=True), file
        )
    if resumed is not None:
        np.testing.assert_array_equal(resumed.gear_speed.values, whole.gear_speed.values)


@pytest.mark.parametrize(("attribute", "value"), list(zip(ATTRIBUTES, VALUES, strict=True)), ids=ATTRIBUTES)
def test_an_attribute_of_another_type_ends_in_one_line(
    tmp_path, partial, partial_case, capsys, attribute, value
):
    """Arrays, bytes, huge and empty texts, numbers for texts and texts for numbers."""
    file = copied(partial, tmp_path)
    with Journal(journal_of(file), "run") as journal:
        frames = list(journal.frames())
        tables = [{name: journal.table(frame, name) for name in frame.shapes} for frame in frames]
    attributes = journal.head.header["attributes"] | {
        attribute: value.tolist() if attribute == "status" else value
    }
    with Journal.create(journal_of(file), "run", attributes=attributes) as journal:
        for frame, arrays in zip(frames, tables, strict=True):
            journal.append(frame.header, arrays)
    read_by_commands(file, partial_case, tmp_path, capsys, pictures=attribute in ("title", "scene"))


def test_an_undamaged_partial_archive_is_resumed(tmp_path, partial, partial_case, capsys):
    file = copied(partial, tmp_path)
    read_by_commands(file, partial_case, tmp_path, capsys)
    assert open_archive(file).attrs["status"] == "finished"
