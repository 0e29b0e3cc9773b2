"""Texts with a unit: exact factors, and a plain answer to everything that is none."""

import math
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearidae.scene.units import from_text, refuse_bare


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("34.715 um", "m", 34.715e-6),
        ("34.715um", "m", 34.715e-6),
        ("34.715 µm", "m", 34.715e-6),  # micro sign
        ("34.715 μm", "m", 34.715e-6),  # Greek mu
        ("  +3.4715e1 um ", "m", 34.715e-6),
        ("\u22121 nm", "m", -1e-9),  # typographic minus
        (".5 mm", "m", 0.5e-3),
        ("161 GPa", "Pa", 161e9),
        ("0.6 ug", "kg", 6e-10),
        ("169 / um^2", "1/m^2", 1.69e14),
        ("169 1/um**2", "1/m^2", 1.69e14),
        ("169 um^-2", "1/m^2", 1.69e14),
        ("169 µm⁻²", "1/m^2", 1.69e14),
        ("8e-18 N·m·s²/rad²", "N m s^2/rad^2", 8e-18),
        ("8e-18 N m s^2", "N m s^2/rad^2", 8e-18),
        ("24.3 pN*m", "N m", 2.43e-11),
        ("24.3 pNm", "N m", 2.43e-11),
        ("1 Nm s/rad", "N m s/rad", 1.0),
        ("1.5 rad s-1", "rad/s", 1.5),  # as in archives
        ("3 kg m2", "kg m^2", 3.0),
        ("169 1/um2", "1/m^2", 1.69e14),
        ("0.1 J/m2", "J/m^2", 0.1),
        ("0.1 J/(m^2)", "J/m^2", 0.1),
        ("10 kHz", "Hz", 10e3),
        ("60 rpm", "rad/s", 2 * math.pi),
        ("1 turn/s", "rad/s", 2 * math.pi),
        ("20 deg", "rad", math.radians(20)),
        ("20°", "rad", math.radians(20)),
        ("0.5", "1", 0.5),
        ("50 %", "1", 0.5),
        ("50 percent", "1", 0.5),
        ("0 m", "m", 0.0),
        ("25 degC", "K", 298.15),
        ("25 °C", "K", 298.15),
        ("25 \u2103", "K", 298.15),
        ("77 degF", "K", 298.15),
        ("-40 degF", "K", 233.15),
        ("298.15 K", "K", 298.15),
        ("1 J/degC", "J/K", 1.0),
        ("1500 1/min", "rad/s", 1500 * 2 * math.pi / 60),
        ("1500 min^-1", "rad/s", 1500 * 2 * math.pi / 60),
        ("1500 rpm", "rad/s", 1500 * 2 * math.pi / 60),
        ("3 1/s", "rad/s", 3.0),
        ("3 rad s^-1", "rad/s", 3.0),
        ("3 rad/min", "rad/s", 0.05),
        ("180 deg/s", "rad/s", math.pi),
        ("2 kN m s", "N m s/rad", 2e3),
    ],
)
def test_reads_exactly(text: str, unit: str, value: float) -> None:
    """Factors are decimals of 28 digits, so the result is the float nearest to what was written."""
    assert from_text(text, unit) == value


@pytest.mark.parametrize(
    ("text", "unit", "reason"),
    [
        ("34.7", "m", "lacks a unit"),
        ("20", "rad", "lacks a unit"),
        ("34.7 kg", "m", "does not fit"),
        ("3 um^2", "m", "does not fit"),
        ("20 degC", "m", "does not fit"),
        ("3 dB", "m", "does not fit"),
        ("3 deg", "1", "does not fit"),
        ("50 %", "rad", "does not fit"),
        ("100 rpm", "Hz", "does not fit"),
        ("100 rad/s", "Hz", "does not fit"),
        ("100 kHz", "rad/s", "does not fit"),
        ("100 1/h", "rad/s", "does not fit"),
        ("100 cps", "rad/s", "does not fit"),
        ("100 Bq", "rad/s", "does not fit"),
        ("1 N m/Hz", "N m s/rad", "does not fit"),
        ("1 N m min", "N m s/rad", "does not fit"),
        ("1 N m/kHz^2", "N m s^2/rad^2", "does not fit"),
        ("1 N m s^2/deg", "N m s^2/rad^2", "does not fit"),  # one angle where two are wanted
        ("2 turn^2", "rad", "does not fit"),
        ("2 delta_degC", "K", "difference of temperatures"),
        ("25 degC", "J/K", "does not fit"),
        ("1 degC", "1", "does not fit"),
        ("3**2 um", "m", "is not a unit"),
        ("3^2 um", "m", "is not a unit"),
        ("3 ** 2 um", "m", "is not a unit"),
        ("3² um", "m", "is not a unit"),
        ("3*2 um", "m", "is not a unit"),
        ("3 parsnip", "m", "not a known unit"),
        ("3 dB", "1", "not a known unit"),
        ("3 m +", "m", "is not a unit"),
        ("3 m/", "m", "not a known unit"),
        ("3 ((m", "m", "not a known unit"),
        ("3 2 m", "m", "is not a unit"),
        ("3 __import__('os')", "m", "is not a unit"),
        ("1,5 um", "m", "has a comma in its number"),
        ("0,5", "1", "has a comma in its number"),
        ("3 m,", "m", "is not a unit"),
        ("0.2 Nm", "m", "does not fit"),
        ("1 Nms/rad", "N m s/rad", "does not fit"),
        ("9**9**9**9 m", "m", "is not a unit"),
        ("1 m**9**9**9", "m", "is not a unit"),
        ("1 m^99999999", "m", "is not a unit"),
        ("um", "m", "must be a number with a unit"),
        ("nan m", "m", "must be a number with a unit"),
        ("inf m", "m", "must be a number with a unit"),
        ("", "m", "must be a number with a unit"),
        ("abc", "1", "must be a number"),
        ("1 " + "m" * 1000, "m", "must be a number with a unit"),
        ("1e99999999999999999999 m", "m", "finite"),
    ],
)
def test_refuses(text: str, unit: str, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        from_text(text, unit)


def test_angles_of_gains_and_drags_count() -> None:
    """To 1e-15: pi is rounded on both ways."""
    assert from_text("2 N m/rpm", "N m s/rad") == pytest.approx(60 / math.pi, rel=1e-15)
    assert from_text("1 N m/(turn/s)^2", "N m s^2/rad^2") == pytest.approx(0.25 / math.pi**2, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "kelvin"), [("2 degC", 2.0), ("9 degF", 5.0), ("2 delta_degC", 2.0), ("2 K", 2.0), ("2 °C", 2.0)]
)
def test_difference_of_temperatures_has_no_zero(text: str, kelvin: float) -> None:
    assert from_text(text, "K", difference=True) == kelvin


@given(st.text(max_size=40), st.sampled_from(["m", "rad", "1", "Hz", "K", "rad/s", "N m s^2/rad^2"]))
def test_any_text_is_read_or_refused(text: str, unit: str) -> None:
    try:
        value = from_text(text, unit)
    except ValueError:
        return
    assert isinstance(value, float)


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_written_numbers_come_back(value: float) -> None:
    assert from_text(f"{value!r} m", "m") == value


def test_pint_is_loaded_only_for_texts() -> None:
    """A scene of plain numbers must not pay for pint, a text must load it."""
    program = (
        "import sys\n"
        "from gearidae.scene import preset\n"
        "scene = preset('teodorescu2009').replace({'coating.sam_fraction': 0.5})\n"
        "assert 'pint' not in sys.modules\n"
        "assert not {'numba', 'scipy', 'xarray', 'matplotlib'} & set(sys.modules)\n"
        "scene.replace({'initial.gap': '30 nm'})\n"
        "assert 'pint' in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True, timeout=60)


@pytest.mark.parametrize(
    "unit", ["count", "counts", "kcount", "%", "percent", "ppm", "bit", "byte", "permille"]
)
def test_counts_and_parts_are_no_angles(unit: str) -> None:
    for text, wanted in ((f"25 {unit}/s", "rad/s"), (f"25 {unit}", "rad"), (f"1 N m s/{unit}", "N m s/rad")):
        with pytest.raises(ValueError, match="does not fit"):
            from_text(text, wanted)
    assert from_text("25 count/s", "Hz") == 25.0
    assert from_text("169 count/um^2", "1/m^2") == 1.69e14


@pytest.mark.parametrize(
    "texts", [("1", "2 nm"), ("2 nm", 1.0), ("-1e-9", "2nm", "3"), ("0", "25 degC"), ("0.5", "60 %")]
)
def test_a_bare_number_beside_a_unit_is_refused(texts: tuple[object, ...]) -> None:
    with pytest.raises(ValueError, match="has no unit beside"):
        refuse_bare(texts)


def test_a_unit_at_the_end_of_a_list_is_no_unit_of_all() -> None:
    with pytest.raises(ValueError, match=r"^2 has no unit beside 6 aN m: give each its unit \(2 aN m\), or"):
        refuse_bare(("2", "4", "6 aN m"))
    with pytest.raises(ValueError, match=r"^4 has no unit beside 2 aN m: give each its unit, or"):
        refuse_bare(("2 aN m", "4"))


@pytest.mark.parametrize(
    "texts", [("1", 2.0), ("1 nm", "2 um"), (0, "0.0", "2 nm"), ("a", None, True, "1 nm")]
)
def test_numbers_that_are_alike_are_left_alone(texts: tuple[object, ...]) -> None:
    refuse_bare(texts)
