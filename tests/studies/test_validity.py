"""How far the model holds: numbers computed independently of the package, verdicts, and the archive's attribute."""

from __future__ import annotations

import json
import math
import subprocess
import sys

import numpy as np
import pytest

import gearidae as gd
from gearidae.contact import line_force
from gearidae.mesh.pair_contact import pair_contact
from gearidae.runs.estimates import rest_of
from gearidae.runs.validity import validity_attribute, validity_rows
from gearidae.scene.validity_row import mean_note, rows_from_json

LOW = gd.preset("teodorescu2009_low_speed")
HIGH = gd.preset("teodorescu2009")

ROWS = [
    *(
        "expected_asperities",
        "density_product",
        "merging_bare",
        "merging_coated",
        "tabor_bare",
        "tabor_coated",
    ),
    *(
        "thermal_motion",
        "gas_damping",
        "net_adhesion",
        "attraction",
        "attraction_behind",
        "memory",
        "tooth_errors",
        "disc_drag",
        "inertia_pinion",
        "inertia_gear",
        "yielding",
    ),
]


def number(scene, name):
    return gd.studies.validity(scene).number[name]


@pytest.mark.parametrize(
    ("scene", "fraction", "gap", "count"),
    [
        (LOW, 1.0, 6.075, 5.1e-8),
        (LOW, 0.5, 5.743, 4.0e-7),
        (HIGH, 1.0, 3.080, 0.115),
        (HIGH, 0.0, 2.768, 0.325),
    ],
)
def test_expected_asperities(scene, fraction, gap, count):
    """Gap and count as an independent program found them, to the digits it printed."""
    worn = scene.replace({"coating.sam_fraction": fraction})
    load = worn.drive.torque / worn.gears.pinion_base_radius
    assert pair_contact(worn).resting_gap(load) / 6e-9 == pytest.approx(gap, abs=5.1e-4)
    digits = 5e-3 if count > 0.01 else 1.3e-2
    assert number(worn, "expected_asperities") == pytest.approx(count, rel=digits, abs=0)
    assert f"gap {gap:.2f}"[:7] in gd.studies.validity(worn).verdict["expected_asperities"]


def test_numbers_of_the_surfaces():
    rows = gd.studies.validity(LOW)
    assert list(rows.index) == ROWS
    assert rows.number["density_product"] == pytest.approx(0.456, abs=5e-4)
    assert rows.value["merging_bare"] == "46.6 nm"
    assert rows.limit["merging_bare"].startswith("38.5 nm")
    assert rows.value["tabor_bare"] == "5 to 2.7"
    assert rows.value["tabor_coated"] == "0.82 to 0.45"


def test_thermal_motion():
    assert number(LOW, "thermal_motion") == pytest.approx(5.4e-9, rel=5e-3)  # to the digits printed
    contact = pair_contact(LOW)
    gap = contact.resting_gap(LOW.drive.torque / LOW.gears.pinion_base_radius)
    assert contact.stiffness(gap) == pytest.approx(1.42e-4, rel=4e-3)
    assert "6 nm" in gd.studies.validity(LOW).limit["thermal_motion"]
    assert gd.studies.validity(HIGH).holds["thermal_motion"]


def test_the_gear_is_57_times_lighter_than_a_disc():
    rows = gd.studies.validity(HIGH)
    assert rows.bound["inertia_gear"] / rows.number["inertia_gear"] == pytest.approx(57.2, abs=0.5)
    assert "57 times lighter" in rows.verdict["inertia_gear"]
    assert rows.holds["inertia_pinion"]


@pytest.mark.parametrize("fraction", [0.5, 0.0])
def test_net_adhesion_is_the_deepest_valley_of_the_parting_force(fraction):
    """Loaded to the resting gap, then opened in fine steps with what has joined."""
    scene = HIGH.replace({"coating.sam_fraction": fraction})
    contact = pair_contact(scene)
    gap = contact.resting_gap(scene.drive.torque / scene.gears.pinion_base_radius)
    opened = np.linspace(0.0, 10e-9, 10_001)
    parts = ((fraction, scene.coated_surface), (1.0 - fraction, scene.surface))
    force = sum(
        share * line_force(gap + opened, opened, contact.radius, 2e-6, surface) for share, surface in parts
    )
    # the valley may end in a kink, where asperities let go: within 1 pm the force changes by 1e-4
    assert number(scene, "net_adhesion") == pytest.approx(-force.min(), rel=2e-4, abs=0)


def test_a_population_needs_no_mean_law():
    """Numbers and limits are those of the mean law; verdicts say that each asperity is followed."""
    mean = gd.studies.validity(LOW)
    real = gd.studies.validity(LOW.replace({"contact.roughness": "discrete"}))
    for name in ("expected_asperities", "memory"):
        assert (real.number[name], real.bound[name]) == (mean.number[name], mean.bound[name])
        assert real.holds[name]
        assert not mean.holds[name]
        assert "each asperity" in real.verdict[name]


def test_verdicts_follow_the_limits():
    few, many = (
        LOW,
        LOW.replace({"drive.torque": 4.5e-6, "surface.asperity_density": 1.5e13, "gears.face_width": 2e-5}),
    )
    rows, other = gd.studies.validity(few), gd.studies.validity(many)
    assert not rows.holds["expected_asperities"]
    assert "ensemble mean" in rows.verdict["expected_asperities"]
    assert other.number["expected_asperities"] > other.bound["expected_asperities"] > 100.0
    between = gd.studies.validity(LOW.replace({"drive.torque": 4.5e-8, "surface.asperity_density": 1.5e13}))
    assert 10.0 < between.number["expected_asperities"] < between.bound["expected_asperities"]
    assert not between.holds["expected_asperities"]
    assert other.holds["expected_asperities"]
    assert not rows.holds["density_product"]
    assert other.holds["density_product"]
    assert other.holds["merging_bare"]


def test_memory_travels_with_the_pair():
    """At f = 0.5 the contact is some 0.4 um wide; 6.59 um of the pinion's flank roll through it."""
    rows = gd.studies.validity(LOW.replace({"coating.sam_fraction": 0.5}))
    assert not rows.holds["memory"]
    assert "(398 nm of 6.59 um)" in rows.verdict["memory"]
    assert rows.number["memory"] == pytest.approx(0.398 / 6.586, rel=2e-3, abs=0)  # to the digits shown
    assert "no memory" in gd.studies.validity(LOW.replace({"contact.asperity": "dmt"})).verdict["memory"]
    assert "memory" not in gd.studies.validity(gd.preset("roller_slow")).index


def test_a_line_beside_a_verdict_where_the_mean_law_does_not_hold():
    assert mean_note(validity_rows(LOW)) == "mean over many gears: 5.13e-08 asperities in contact"
    many = LOW.replace({"drive.torque": 4.5e-6, "surface.asperity_density": 1.5e13, "gears.face_width": 2e-5})
    assert mean_note(validity_rows(many)) == ""
    assert mean_note(validity_rows(LOW.replace({"drive.torque": 0.0}))) == ""


@pytest.mark.parametrize(("law", "holds"), [("jkr", False), ("dmt", False), ("hertz", True)])
def test_the_tabor_parameter_is_judged_by_the_law_that_is_used(law, holds):
    assert gd.studies.validity(LOW.replace({"contact.asperity": law})).holds["tabor_coated"] == holds
    stiff = LOW.replace({"contact.asperity": law, "coating.energy": 1e-3})  # 0.04 to 0.02
    assert gd.studies.validity(stiff).holds["tabor_coated"] == (law != "jkr")


def test_without_a_load_nothing_rests():
    rows = gd.studies.validity(LOW.replace({"drive.torque": 0.0}))
    for name in ("expected_asperities", "thermal_motion", "gas_damping", "net_adhesion", "memory"):
        assert rows.value[name] == "-"
        assert "no resting contact" in rows.verdict[name]
        assert math.isnan(rows.number[name])


def test_a_roller_is_judged_at_its_closest_approach():
    rows = gd.studies.validity(gd.preset("roller_slow"))
    assert not {"disc_drag", "inertia_gear"} & set(rows.index)
    # with rigid bodies: 17.5 uN of peak force, 1.26 uN of tension (docs/validation.md)
    assert rows.bound["net_adhesion"] == pytest.approx(17.5e-6, rel=0.01)
    assert rows.number["net_adhesion"] == pytest.approx(1.26e-6, rel=0.01)


@pytest.mark.parametrize("scene", [LOW, HIGH, gd.preset("roller_fast"), LOW.replace({"drive.torque": 0.0})])
def test_the_attribute_reads_back(scene):
    text = validity_attribute(scene)
    assert "NaN" not in text
    assert json.loads(text)[0]["name"] == "expected_asperities"
    for read, row in zip(rows_from_json(text), validity_rows(scene), strict=True):
        for field in row.__slots__:
            reread, wanted = getattr(read, field), getattr(row, field)
            assert reread == wanted or (math.isnan(reread) and math.isnan(wanted))


SOUND = json.loads(validity_attribute(LOW))


def changed(**entries):
    """The attribute with entries of its first row changed."""
    return json.dumps([SOUND[0] | entries, *SOUND[1:]])


@pytest.mark.parametrize(
    "text",
    [
        *("[1]", "[{}]", '[{"name": "x"}]', '{"a": 1}', "3", "null", "[" * 100_000),
        changed(number="no number"),
        changed(bound=[1.0]),
        changed(number=10**400),
        changed(more="than there is"),
    ],
)
def test_what_is_no_table_has_no_rows(text):
    assert rows_from_json(text) == []


@pytest.mark.parametrize("attribute", [None, 3, b"[]", np.arange(3), "", "[1"])
def test_other_attributes_have_no_rows(attribute):
    assert rows_from_json(attribute) == []


def test_neither_numba_nor_the_engine_is_needed():
    script = (
        "import sys, gearidae as gd\n"
        "from gearidae.runs.validity import validity_attribute\n"
        "validity_attribute(gd.preset('teodorescu2009'))\n"
        "print([name for name in sys.modules if name == 'numba' or name.startswith('gearidae.engine')])"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True, timeout=120
    )
    assert done.stdout.strip() == "[]"


def test_the_fast_roller_yields_and_gears_at_rest_do_not():
    """Less than one asperity is expected to carry a gear at rest: it carries all of the force."""
    fast, high = gd.studies.validity(gd.preset("roller_fast")), gd.studies.validity(HIGH)
    assert not fast.holds["yielding"]
    assert "yields at the closest approach" in fast.verdict["yielding"]
    assert high.holds["yielding"]
    assert high.number["yielding"] == pytest.approx(2.43e-11 / 34.715e-6 / 46.7e-6, rel=1e-3)
    sharp = gd.studies.validity(HIGH.replace({"surface.asperity_radius": 160e-9}))
    assert "5.9 uN" in sharp.limit["yielding"]
    assert math.isnan(number(LOW.replace({"drive.torque": 0.0}), "yielding"))


def test_friction_near_locking():
    """The gear's teeth lock the pinion at 1.615; a hub at its base radius over its own radius."""
    assert not {"locking_teeth", "locking_hubs"} & set(gd.studies.validity(HIGH).index)
    hubs = {"gears.hub_friction": 0.5, "gears.gear_hub_radius": 6e-6}
    rows = gd.studies.validity(HIGH.replace({"contact.friction": 0.3, **hubs}))
    assert rows.number["locking_teeth"] == 0.3
    assert rows.bound["locking_teeth"] == pytest.approx(0.5 * 1.615, rel=5e-4)
    assert rows.holds["locking_teeth"]
    assert rows.bound["locking_hubs"] == pytest.approx(0.5 * 138.86 / 6.0, rel=1e-9)
    near = gd.studies.validity(HIGH.replace({"contact.friction": 1.4, "coating.friction": 1.2}))
    assert near.number["locking_teeth"] == 1.2  # the coating covers all of it
    assert not near.holds["locking_teeth"]
    assert "near self-locking" in near.verdict["locking_teeth"]
    assert "locking_hubs" not in near.index


def test_a_solid_disc_is_that_of_the_density():
    """Gears whose inertia follows from silicon's density are solid discs of silicon."""
    rows = gd.studies.validity(HIGH.replace({"gears.density": "2330 kg/m^3"}))
    for name in ("inertia_pinion", "inertia_gear"):
        assert rows.number[name] == pytest.approx(rows.bound[name], rel=1e-14, abs=0)


def test_errors_of_teeth_are_compared_with_what_the_load_closes():
    scene = HIGH
    rows = gd.studies.validity(scene)
    assert rows.number["tooth_errors"] == 10e-9  # assumed, as the scene has none
    assert "left out of the scene" in rows.verdict["tooth_errors"]
    assert not rows.holds["tooth_errors"]
    inside = gd.studies.validity(scene.replace({"mesh.pitch_error_rms": 1e-10}))
    drawn = gd.pitch_errors(scene.replace({"mesh.pitch_error_rms": 1e-10}))
    rms = math.hypot(drawn.pinion_pitch_error.values.std(), drawn.gear_pitch_error.values.std())
    assert inside.number["tooth_errors"] == pytest.approx(rms, rel=1e-12, abs=0)
    assert "pairs share the load" in inside.verdict["tooth_errors"]
    assert inside.holds["tooth_errors"]


def test_the_journal_must_follow_the_force_of_the_drive():
    engine = gd.load_case("cases/microengine.toml")
    assert "journal" not in gd.studies.validity(engine).index
    loose = engine.replace({"gears.pinion_hub_clearance": "0.5 um"})
    rows = gd.studies.validity(loose)
    # 600 Hz at the end of the ramp, beside a disc of the pinion's inertia on 10 uN over 0.5 um
    assert rows.number["journal"] == pytest.approx(2.0 * math.pi * 600.0, rel=1e-6)
    mass = 2.0 * 9.6e-21 / (34.715e-6 / math.cos(math.radians(20.0))) ** 2
    assert rows.bound["journal"] == pytest.approx(math.sqrt(10e-6 / (mass * 0.5e-6)) / 3.0, rel=1e-9)
    assert rows.holds["journal"]
    assert "swings by up to 1.44 %" in rows.verdict["journal"]
    fast = loose.replace({"drive.law.frequency": "200 kHz"})
    assert not gd.studies.validity(fast).holds["journal"]


def test_a_pair_s_force_falls_e_fold_over_the_closure_of_the_load():
    rest = rest_of(HIGH)
    closure = gd.studies.validity(HIGH).bound["tooth_errors"]
    wider = float(rest.contact.force(rest.gap + 0.1 * closure))
    assert wider / rest.load == pytest.approx(math.exp(-0.1), rel=2e-2)
