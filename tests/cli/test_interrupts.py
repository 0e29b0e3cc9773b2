"""An interrupt that Python drops is raised again."""

import sys
import time

import pytest

from gearidae.cli.interrupts import interrupts_kept


class Dropped:
    """Raises where nothing can be raised."""

    def __init__(self, error):
        self.error = error

    def __del__(self):
        raise self.error


def drop_one_and_wait():
    one = Dropped(KeyboardInterrupt())
    del one
    for _ in range(500):
        time.sleep(0.01)


def test_an_interrupt_in_a_destructor_is_not_lost():
    with pytest.raises(KeyboardInterrupt), interrupts_kept():
        drop_one_and_wait()


def test_other_errors_go_where_they_went(monkeypatch):
    seen = []
    monkeypatch.setattr(sys, "unraisablehook", lambda found: seen.append(type(found.exc_value)))
    with interrupts_kept():
        one = Dropped(ValueError())
        del one
    assert seen == [ValueError]
