"""Loading a case or an archive runs no code from it and writes nowhere but to the file that was named."""

import contextlib
import os
import shutil
import sys

import netCDF4
import pytest

import gearidae as gd
from gearidae.cli import main
from gearidae.errors import SceneError

HOSTILE = [
    "__import__('os').system('touch pwned')",
    "{0.__class__.__mro__}",
    "$(touch pwned)",
    "`touch pwned`; touch pwned",
    "../../pwned",
    "<script>alert(1)</script>",
    "!!python/object/apply:os.system ['touch pwned']",
    "cos\nsystem\n(S'touch pwned'\ntR.",
]
FORBIDDEN = (
    "os.",
    "shutil.",
    "subprocess.",
    "socket.connect",
    "pickle.find_class",
    "marshal.loads",
    "exec",
    "ctypes.dlopen",
)
CASE = """
name = {name}
[roller]
radius = "5 um"
mass = "0.6 ug"
width = "2 um"
speed = "0.01 m/s"
height = "40 nm"
[surface]
youngs_modulus = "161 GPa"
poisson_ratio = 0.23
energy = 1.5
asperity_density = 1.69e14
asperity_radius = "450 nm"
roughness = {roughness}
[coating]
sam_fraction = 0
energy = 0.1
[run]
duration = "1 us"
samples = 11
"""


class Watch:
    """What the interpreter reports of itself while it is armed; a hook cannot be taken off again."""

    def __init__(self):
        self.armed, self.seen = False, []
        sys.addaudithook(self)

    def __call__(self, event, arguments):
        if not self.armed:
            return
        if event == "open":
            path, _, flags = arguments
            if isinstance(flags, int) and flags & (os.O_WRONLY | os.O_RDWR | os.O_CREAT):
                self.seen.append(f"open {path} for writing")
        elif event.startswith(FORBIDDEN) and event not in ("os.listdir", "os.scandir"):
            self.seen.append(f"{event} {arguments}")

    @contextlib.contextmanager
    def on(self):
        self.seen.clear()
        self.armed = True
        try:
            yield self.seen
        finally:
            self.armed = False


WATCH = Watch()


def literal(text):
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") + '"'


def attempt(read, file):
    try:
        return read(file)
    except SceneError:
        return None


def everything_below(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


def test_the_watch_sees_what_it_is_for(tmp_path):
    with WATCH.on() as seen:
        (tmp_path / "file").write_text("")
        os.system("true")
        exec("pass")
    assert len(seen) == 3


@pytest.mark.parametrize("text", HOSTILE)
def test_loading_a_case_runs_nothing(tmp_path, text):
    file = tmp_path / "case.toml"
    for name, roughness in ((text, "6 nm"), ("plain", text), ("plain", "6 " + text)):
        file.write_text(CASE.format(name=literal(name), roughness=literal(roughness)))
        attempt(gd.load_case, file)  # what is loaded on first use is loaded
        with WATCH.on() as seen:
            attempt(gd.load_case, file)
        assert seen == []
    assert everything_below(tmp_path) == ["case.toml"]


@pytest.fixture(scope="module")
def plain_archive(tmp_path_factory):
    file = tmp_path_factory.mktemp("plain") / "run.nc"
    gd.simulate(gd.preset("roller_slow").replace({"run.samples": 51}), archive=file)
    return file


def poisoned(plain_archive, folder, text):
    """An archive with a text in every attribute that is one, one after the other."""
    with netCDF4.Dataset(plain_archive) as ds:
        names = [name for name in ds.ncattrs() if isinstance(ds.getncattr(name), str)]
    for name in ("", *names):
        file = folder / "run.nc"
        shutil.copyfile(plain_archive, file)
        with netCDF4.Dataset(file, "a") as ds:
            if name:
                ds.setncattr(name, text)
            else:
                for variable in ds.variables.values():
                    variable.setncattr("long_name", text)
        yield file


@pytest.mark.parametrize("text", HOSTILE[::3])
def test_opening_an_archive_runs_nothing(tmp_path, plain_archive, text):
    for number, file in enumerate(poisoned(plain_archive, tmp_path, text)):
        if number == 0:
            attempt(gd.open_archive, file)
        with WATCH.on() as seen:
            attempt(gd.open_archive, file)
        assert seen == []
    assert everything_below(tmp_path) == ["run.nc"]


@pytest.mark.parametrize("text", ["../../pwned", "<script>alert(1)</script>"])
def test_a_name_in_a_file_leads_nowhere(tmp_path, monkeypatch, text, capsys):
    """The scene's name goes into titles, never into a path, and is no code in a page."""
    folder = tmp_path / "deep" / "inside"
    folder.mkdir(parents=True)
    monkeypatch.chdir(folder)
    (folder / "case.toml").write_text(CASE.format(name=literal(text), roughness='"6 nm"'))
    assert main(["run", "case.toml"]) == 0
    assert main(["plot", "case.nc"]) == 0
    assert main(["report", "case.nc", "-o", "page.html"]) == 0
    assert main(["info", "case.nc"]) == 0
    assert everything_below(tmp_path) == [
        "deep",
        "deep/inside",
        *(f"deep/inside/case.{ending}" for ending in ("nc", "png", "toml")),
        "deep/inside/page.html",
    ]
    assert "<script>alert" not in (folder / "page.html").read_text()
