"""Reading ``key=value`` from the command line."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearidae.cli import main
from gearidae.cli.case import default_output
from gearidae.cli.command_line import spread
from gearidae.errors import SceneError
from gearidae.scene.pairs import assignments, sweep_values


@pytest.mark.parametrize(
    ("pair", "value"),
    [
        ("a.b=0.5", 0.5),
        ("a.b=3", 3),
        ("a.b=1e-6", 1e-6),
        ("a.b = 0.2 um", "0.2 um"),
        ('a.b="0.2 um"', "0.2 um"),
        ("a.b=elastic", "elastic"),
        ("a.b=[[0, 1e-18], [1.0, 2e-18]]", [[0, 1e-18], [1.0, 2e-18]]),
        ("a.b={amplitude = 1e-19, frequency = 10}", {"amplitude": 1e-19, "frequency": 10}),
        ("a.b=x=y", "x=y"),
        ("a.b=1\nc=2", "1\nc=2"),  # a line break begins no second key
    ],
)
def test_values_are_toml_or_text(pair, value):
    assert assignments([pair]) == {"a.b": value}


@pytest.mark.parametrize("pair", ["a.b", "=1", "a.b=", "", " = "])
def test_pairs_that_are_none(pair):
    for read, option in ((assignments, "--set"), (sweep_values, "--over")):
        with pytest.raises(SceneError, match=f"^{option} = .*must read key=value"):
            read([pair])


def test_no_key_twice():
    with pytest.raises(SceneError, match="is given twice"):
        assignments(["a=1", "a=2"])
    with pytest.raises(SceneError, match="is given twice"):
        sweep_values(["a=1,2", "a=3"])


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("1:0.4:-0.2", [1.0, 0.8, 0.6, 0.4]),
        ("0:1:0.3", [0.0, 0.3, 0.6, 0.9]),
        ("1:1:1", [1.0]),
        ("1e-18:3e-18:1e-18", [1e-18, 2e-18, 3e-18]),
        ("0.1:0.3:0.1 um", ["0.1 um", "0.2 um", "0.3 um"]),
        ("2 um:1 um:-1 um", ["2 um", "1 um"]),
        ("1,0.5, 0.47", [1, 0.5, 0.47]),
        ("0.2 um,0.1 um", ["0.2 um", "0.1 um"]),
        ("asperity,elastic", ["asperity", "elastic"]),
        ("[1, 2]", [1, 2]),
        ("[[[0, 1]], [[0, 2]]]", [[[0, 1]], [[0, 2]]]),
        ("0.5", [0.5]),
    ],
)
def test_values_to_sweep_over(text, values):
    assert sweep_values([f"a.b={text}"]) == {"a.b": values}


@given(
    start=st.integers(-1000, 1000),
    step=st.integers(-50, 50).filter(bool),
    steps=st.integers(0, 200),
    digits=st.integers(0, 12),
)
def test_ranges_hold_the_decimals_that_were_meant(start, step, steps, digits):
    """Each value is the float nearest to the exact decimal, both ends included; adding up steps would not give that."""
    texts = [f"{number}e-{digits}" for number in (start, start + steps * step, step)]
    expected = [float(f"{start + number * step}e-{digits}") for number in range(steps + 1)]
    assert sweep_values([f"a={':'.join(texts)}"]) == {"a": expected}


@pytest.mark.parametrize(
    "text",
    [
        "1:2",
        "1:2:3:4",
        "1:2:0",
        "1:2:-1",
        "2:1:1",
        "a:b:c",
        "0:nan:1",
        "0:inf:1",
        "0:1:1e-9",
        "1 um:2 um:1",
        "1 um:2 um:500 nm",
    ],
)
def test_ranges_that_are_none(text):
    with pytest.raises(SceneError, match=r"^a\.b = "):
        sweep_values([f"a.b={text}"])


@pytest.mark.parametrize("text", ["0.4-0.6", "0.4..0.6", "0.4 to 0.6", "-1e-6 - 2e-6", "1-2 um"])
def test_a_range_in_prose_is_told_how_it_is_written(text):
    with pytest.raises(SceneError, match=r"is no range: one is written start:stop:step, such as 0\.4:0\.6:"):
        sweep_values([f"a.b={text}"])


@pytest.mark.parametrize(
    ("text", "spread_out"),
    [
        ("run c.toml --set a=1 b=2 --rtol 3", "run c.toml --set a=1 --set b=2 --rtol 3"),
        ("run --set a=1 b=2 c.toml", "run --set a=1 --set b=2 c.toml"),
        ("sweep c --over a=1,2 b=3 --set c=4", "sweep c --over a=1,2 --over b=3 --set c=4"),
        ("run --set a=1 c=d.toml -o e=f.nc", "run --set a=1 --set c=d.toml -o e=f.nc"),
        ("run a=b.toml --set c=1", "run a=b.toml --set c=1"),
        ("run c --set", "run c --set"),
        ("run c --set=a=1 b=2", "run c --set=a=1 b=2"),
        ("", ""),
    ],
)
def test_several_pairs_after_one_option(text, spread_out):
    assert spread(text.split()) == spread_out.split()


@pytest.mark.parametrize("case", ["cases/low_speed.toml", "low_speed", "../a/low_speed.toml"])
def test_results_are_named_after_their_case(case):
    assert default_output(case, ".nc") == Path("low_speed.nc")


@pytest.mark.parametrize("text", ["4.4 aN m,4.6", "4.4e-18,4.6 aN m", "[4.4e-18, '4.6 aN m']"])
@pytest.mark.parametrize("command", ["sweep", "threshold", "coating-map", "operating-map"])
def test_swept_values_have_units_all_or_none(command, text, capsys):
    over = ["--over", f"drive.torque={text}"]
    if command == "operating-map":
        over.append("coating.sam_fraction=1,0.5")
    assert main([command, "low_speed", *over]) == 2
    assert "has no unit beside" in capsys.readouterr().err
