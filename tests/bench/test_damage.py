"""A small part of the damage that ``python -m gearidae_bench.damage`` does."""

from __future__ import annotations

import pytest

from gearidae_bench.damage import damaged_archives

# a cut, zeros in the head, flips in the head, other bytes in the data, ..., so that each kind meets each place
SEEDS = range(16)


@pytest.mark.filterwarnings("ignore:This process")  # is multi-threaded, says fork
def test_a_damaged_unfinished_archive_is_refused_or_read_up_to_the_damage(tmp_path):
    found = damaged_archives(tmp_path, SEEDS)
    assert sum(found.values()) == len(SEEDS)
    assert set(found) == {"opened, resumed", "refused, not resumed"}
