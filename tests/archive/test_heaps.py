"""Damaged global heaps: refused before HDF5 sees them, which would never come to an end with some of them."""

from __future__ import annotations

import struct
import subprocess
import sys

import pytest

import gearidae as gd
from gearidae.analysis.measured import read_signal
from gearidae.archive.heaps import check_heaps

OPENS = """
import sys
from pathlib import Path
import netCDF4
import gearidae as gd
from gearidae.archive.heaps import check_heaps

source, refused = Path(sys.argv[1]), 0
whole = source.read_bytes()
heap = whole.find(b"GCOL")
for bit in range(8 * heap, 8 * (heap + 16 + 5 * 24 + 16)):
    content = bytearray(whole)
    content[bit // 8] ^= 1 << bit % 8
    source.write_bytes(content)
    try:
        check_heaps("archive", source)
    except gd.SceneError:
        refused += 1
        continue
    try:
        netCDF4.Dataset(source).close()
    except (OSError, RuntimeError):
        pass
print(refused)
"""


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    ds = gd.simulate(gd.preset("roller_slow"), samples=11)
    return gd.save(ds, tmp_path_factory.mktemp("heaps") / "roller.nc").read_bytes()


@pytest.fixture(params=[16, 1032, 2**64 - 16], ids=["next object", "free space", "overflow"])
def damaged(whole, request, tmp_path):
    """An archive whose first object of the heap has another size: the library hangs with each of these."""
    content, file = bytearray(whole), tmp_path / "damaged.nc"
    struct.pack_into("<Q", content, whole.find(b"GCOL") + 24, request.param)
    file.write_bytes(content)
    return file


@pytest.mark.parametrize("read", [gd.open_archive, gd.studies.open_life, read_signal])
def test_damaged_heaps_are_refused_by_name(damaged, read):
    with pytest.raises(gd.SceneError, match=r"damaged\.nc: is damaged \(global heap at byte \d+\)"):
        read(damaged)


@pytest.mark.parametrize("size", [0, 4095, 2**40, 2**64 - 1])
def test_a_heap_is_as_long_as_its_objects(whole, tmp_path, size):
    content, file = bytearray(whole), tmp_path / "damaged.nc"
    struct.pack_into("<Q", content, whole.find(b"GCOL") + 8, size)
    file.write_bytes(content)
    with pytest.raises(gd.SceneError, match="global heap"):
        check_heaps("archive", file)


def test_a_file_may_end_within_a_heap(whole, tmp_path):
    file, heap = tmp_path / "cut.nc", whole.find(b"GCOL")
    for end in (heap + 8, heap + 12, heap + 40, heap + 4095):
        file.write_bytes(whole[:end])
        with pytest.raises(gd.SceneError, match="global heap"):
            check_heaps("archive", file)


def test_what_is_not_refused_comes_to_an_end(whole, tmp_path):
    """Each bit of the headers of the first objects changed, in a process of its own, which may be ended."""
    file = tmp_path / "flipped.nc"
    file.write_bytes(whole)
    done = subprocess.run(
        [sys.executable, "-c", OPENS, str(file)], capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr
    assert 300 < int(done.stdout) < 1000  # sizes and signature, 6 times 64 bits; other bits do no harm
