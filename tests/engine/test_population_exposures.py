"""Exposures of real asperities, and coverage by teeth of both sides, against readable twins."""

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine.backend import solve
from gearidae.populations import flanks_of
from gearidae.populations.materials import along_path, materials_at, materials_met
from gearidae.records import EventKind
from gearidae.scene import MATERIAL_NAMES, preset
from gearidae.scene.coating_table import met_teeth
from reference.population import NUMBERS, Contact, Tip
from reference.rubbing_contacts import ListedAsperities, jkr

PLACES = 6
GEARS = preset("teodorescu2009").replace(
    {"contact.roughness": "discrete", "run.exposures": PLACES, "run.duration": 40e-6, "run.samples": "off"}
)
rng = np.random.default_rng(5)
COATINGS = {
    "patches": {"coating.sam_fraction": 0.5},
    "pinion's teeth": {"coating.pinion_table": rng.random((19, 5)).round(2).tolist()},
    "both sides by tooth": {
        "coating.pairing": "independent",
        "coating.pinion_table": rng.random((19, 3)).round(2).tolist(),
        "coating.gear_table": rng.random((76, 4)).round(2).tolist(),
        "coating.thickness": 1e-9,
    },
    "covered or bare teeth": {
        "coating.pairing": "independent",
        "coating.pinion_fraction": 1.0,
        "coating.gear_table": (np.arange(76) % 2.0).tolist(),
    },
}
COLUMNS = [
    [1e-6 * a, 1e-9 * h, 1e-9 * r] for a, h, r in NUMBERS["gear_explicit"]["list_arc_um_height_nm_radius_nm"]
]
LISTED = dict(zip(("arc", "height", "radius"), np.transpose(COLUMNS).tolist(), strict=True))


def asperity_events(ds):
    """Kind, pair, coast, asperity and time of each event of a single asperity."""
    single = ds.event_asperity.values >= 0
    return zip(
        *(
            ds[name].values[single].tolist()
            for name in ("event_kind", "event_pair", "event_flank", "event_asperity", "event_time")
        ),
        strict=True,
    )


def counted(ds):
    """Contacts and lost energy [J] over flank, material, tooth and place, from the events one by one."""
    scene, names = ds.gearidae.scene, [material.name for material in ds.gearidae.scene.materials()]
    tips = {
        material.name: Tip(material.surface, scene.surface.asperity_radius) for material in scene.materials()
    }
    flanks = {(flank.tooth, flank.flank): flank for flank in flanks_of(scene)}
    contacts, lost = np.zeros((2, 2, len(names), 19, PLACES))
    for kind, pair, coast, asperity, _ in asperity_events(ds):
        pinion, gear = met_teeth(pair, coast=bool(coast))
        flank = flanks[int(pinion) % 19, coast]
        name = MATERIAL_NAMES[materials_at(scene, flank, int(gear))[asperity]]
        place = min(int(PLACES * along_path(scene, flank)[asperity]), PLACES - 1)
        where = coast, names.index(name), flank.tooth, place
        joins = kind == EventKind.ASPERITY_ONSET
        contacts[where] += joins
        lost[where] += tips[name].joining if joins else tips[name].letting_go
    return contacts, lost


@pytest.mark.parametrize("coating", COATINGS)
def test_contacts_and_adhesion_are_those_of_the_events(coating):
    """By tooth, place and material. Mean shares of the materials in a place are quadratures of midpoints there."""
    ds = gd.simulate(GEARS.replace(COATINGS[coating]))
    contacts, lost = counted(ds)
    even = coating == "patches"
    shares = 0.5 if even else shares_of_places(ds)
    ours = (ds.asperity_contacts * ds.flank_area).transpose("flank", "material", "tooth", "place").values
    work = (ds.adhesion_work * ds.flank_area).transpose("flank", "material", "tooth", "place").values
    assert contacts.sum() > 20
    allowed = 1e-6 if even else 1e-4  # of a loss, what the located root leaves out; of the quadrature
    np.testing.assert_allclose(ours * shares, contacts, rtol=1e-12 if even else allowed, atol=0)
    np.testing.assert_allclose(work * shares, lost, rtol=allowed, atol=allowed * lost.max())
    total = ds.gearidae.energy_balance["adhesion_loss"]
    assert float((work * shares).sum()) == pytest.approx(total, rel=1e-12 if even else allowed, abs=0)
    if not even:
        assert ((contacts > 0).any(axis=(0, 2, 3))).sum() > 1  # of several materials


def shares_of_places(ds):
    """Shares of the materials by quadrature over each place, and all teeth of the gear that a tooth meets."""
    coating = ds.gearidae.scene.coating
    pinion, gear = (np.array(table) for table in coating.tables)
    at = (np.arange(PLACES * 200) + 0.5) / (PLACES * 200)
    shares = np.zeros((2, len(ds.material), 19, PLACES))
    for flank in range(2):
        for tooth in range(19):
            f = _along(pinion, tooth, at)
            g = np.mean([_along(gear, tooth + flank + 19 * turn, at) for turn in range(4)], axis=0)
            fractions = {"coated": f, "bare": 1.0 - f}
            if coating.pairing == "independent":
                fractions = {"coated": f * g, "bare": (1 - f) * (1 - g), "mixed": f + g - 2 * f * g}
            for number, name in enumerate(ds.material.values):
                shares[flank, number, tooth] = fractions[name].reshape(PLACES, -1).mean(axis=1)
    return shares


def _along(table, tooth, at):
    row = table[tooth % len(table)]
    u = np.clip(at * row.size - 0.5, 0.0, row.size - 1.0)
    k = np.minimum(u.astype(int), max(row.size - 2, 0))
    u, after = u - k, row[np.minimum(k + 1, row.size - 1)]
    return row[k] + (after - row[k]) * u**3 * (10.0 - 15.0 * u + 6.0 * u**2)


def test_materials_on_any_tooth_of_the_gear_are_those_on_each():
    scene = GEARS.replace(COATINGS["both sides by tooth"])
    flank = flanks_of(scene)[7]
    covered, bare = materials_met(scene, flank)
    for tooth in (0, 3, 75):
        there = materials_at(scene, flank, tooth)
        assert ((there == covered) | (there == bare)).all()
        assert len(set(there.tolist())) == 3


def test_a_table_of_equal_teeth_is_one_number():
    """To the last bit of the motion, as the same asperities join."""
    plain = GEARS.replace({"coating.pairing": "independent", "coating.sam_fraction": 0.4})
    table = plain.replace({"coating.gear_table": [[0.4]] * 76})
    single, other = solve(plain), solve(table)
    assert np.array_equal(single.events.time, other.events.time)
    assert np.array_equal(single.events.asperity, other.events.asperity)


def spans_of(ds):
    """Pair and asperity, start and end of each span in which an asperity of the drive flank is joined."""
    joined, spans = {}, []
    for kind, pair, coast, asperity, t in asperity_events(ds):
        assert coast == 0
        if kind == EventKind.ASPERITY_ONSET:
            joined[pair, asperity] = t
        else:
            spans.append((pair, asperity, joined.pop((pair, asperity)), t))
    return spans + [(pair, asperity, t, np.inf) for (pair, asperity), t in joined.items()]


def test_sliding_work_and_pressure_are_those_of_the_samples():
    """Ten listed asperities, 20,001 samples: a sum over samples of forces that jump at events is good to 1e-4."""
    scene = GEARS.replace(
        {"contact.asperities": LISTED, "coating.sam_fraction": 0.0, "run.samples": 20_001, "run.rtol": 1e-8}
    )
    ds = gd.simulate(scene)
    contact, g, time = Contact(scene), scene.geometry, ds.time.values
    phase = (ds.gear_angle.values - ds.gear_angle.values[0]) * g.base_radius_gear
    phase += scene.initial.mesh_phase * g.base_pitch
    gap = 0.5 * scene.mesh.backlash - ds.transmission_error.values
    forces = {}
    for pair, asperity, start, end in spans_of(ds):
        here = np.flatnonzero((time > start) & (time < end))
        arc, height, radius = (LISTED[name][asperity] for name in ("arc", "height", "radius"))
        xi = phase[here] - pair * g.base_pitch
        overlaps = [contact.overlap(*sample, arc, height)[0] for sample in zip(xi, gap[here], strict=True)]
        forces.setdefault(pair, np.zeros(time.size))[here] += Tip(scene.surface, radius).load(
            np.array(overlaps)
        )
    work, pressure = np.zeros((2, 19, PLACES))
    for pair, force in forces.items():
        inside = np.clip(phase - pair * g.base_pitch, 0.0, g.path_length)
        place = np.minimum((inside / g.path_length * PLACES).astype(int), PLACES - 1)
        speed = np.abs((ds.pinion_speed.values + ds.gear_speed.values) * (inside - g.approach))
        power = np.maximum(force, 0.0) * speed
        work[pair % 19] += np.bincount(place, power * float(time[1]), PLACES)
        radius = np.array([contact.at(xi)["radius"] for xi in inside])
        pressing = force / (scene.gears.face_width * np.sqrt(2.0 * radius * scene.surface.roughness))
        np.maximum.at(pressure[pair % 19], place, pressing)
    ours = (ds.sliding_work * ds.flank_area).sel(flank="drive").values
    assert ours.sum() == pytest.approx(work.sum(), rel=1e-3, abs=0)
    np.testing.assert_allclose(ours, work, rtol=0, atol=1e-3 * work.max())
    largest = ds.largest_pressure.sel(flank="drive").values
    np.testing.assert_allclose(largest, pressure, rtol=0, atol=1e-2 * pressure.max())


@pytest.mark.parametrize(
    "changes",
    [
        {"contact.friction": 0.3},
        {"contact.friction_law": "shear", "contact.shear_strength": "1 GPa"},
    ],
    ids=["coulomb", "shear"],
)
def test_each_asperity_rubs_at_its_own_place(changes):
    """Against samples: a sum over 20,001 of them, of forces that jump at events, is good to 1e-3."""
    listed = {
        "contact.asperities": LISTED,
        "coating.sam_fraction": 0.0,
        "run.samples": 20_001,
        "run.rtol": 1e-8,
    }
    ds = gd.simulate(GEARS.replace(listed | changes))
    scene = ds.gearidae.scene
    contact, g, time = Contact(scene), scene.geometry, ds.time.values
    law = ListedAsperities(scene, [LISTED[name] for name in ("arc", "height", "radius")], 0.3, 1e9)
    phase = (ds.gear_angle.values - ds.gear_angle.values[0]) * g.base_radius_gear
    phase += scene.initial.mesh_phase * g.base_pitch
    gap = 0.5 * scene.mesh.backlash - ds.transmission_error.values
    first = g.base_radius_pinion * np.tan(scene.gears.pressure_angle) - g.approach
    loads, limits = {}, {}
    for pair, asperity, start, end in spans_of(ds):
        here = np.flatnonzero((time > start) & (time < end))
        xi = phase[here] - pair * g.base_pitch
        overlap = [
            contact.overlap(*at, law.arcs[asperity], law.heights[asperity])[0]
            for at in zip(xi, gap[here], strict=True)
        ]
        cube = jkr(np.maximum(np.array(overlap) / law.dc[asperity], -1.0))
        load = 2.0 * law.pc[asperity] * (cube - np.sqrt(2.0 * cube))
        area = np.pi * (3.0 * law.radii[asperity] * law.pc[asperity] / (2.0 * law.modulus) * cube) ** (2 / 3)
        for table, values in ((loads, load), (limits, 1e9 * area)):
            table.setdefault(pair, np.zeros((time.size, len(law.arcs))))[here, asperity] += values
    work = np.zeros((19, PLACES))
    for pair, load in loads.items():
        inside = first + np.clip(phase - pair * g.base_pitch, 0.0, g.path_length)
        both = (g.base_radius_pinion + g.base_radius_gear) * np.tan(scene.gears.pressure_angle)
        speed = np.abs(inside * ds.pinion_speed.values - (both - inside) * ds.gear_speed.values)
        if "contact.friction" in changes:  # the pair's friction is shared by those that push
            pushes = np.maximum(load, 0.0)
            total = pushes.sum(axis=1, keepdims=True)
            share = np.divide(pushes, total, out=np.zeros_like(pushes), where=total > 0.0)
            power = 0.3 * np.maximum(load.sum(axis=1, keepdims=True), 0.0) * share
        else:
            power = limits[pair]
        along = np.sqrt(2.0 * g.base_radius_pinion * law.arcs) - first
        place = np.minimum((np.clip(along / g.path_length, 0.0, 1.0) * PLACES).astype(int), PLACES - 1)
        work[pair % 19] += np.bincount(place, (power * speed[:, None]).sum(axis=0) * time[1], PLACES)
    ours = (ds.friction_work * ds.flank_area).sel(flank="drive").values
    total = ds.gearidae.energy_balance["drive_friction_loss"]
    assert ours.sum() == pytest.approx(total, rel=1e-12, abs=0)  # the same quadrature, added up otherwise
    assert (work.sum(axis=0) > 0.0).sum() > 1
    np.testing.assert_allclose(ours, work, rtol=0, atol=2e-3 * work.max())


@pytest.mark.parametrize("energy", ["10 J/m^2", "1e-3 J/m^2"])
def test_a_life_of_real_asperities(energy):
    """By cycle jumps, or where coverage is lost too fast for that cycle by cycle, each with what the last has left."""
    scene = GEARS.replace({"coating.sam_fraction": 0.9, "run.exposures": 0})
    life = gd.studies.life(
        scene,
        gd.wear.loss_law("adhesion_work", energy=energy),
        fraction=0.6,
        cycles=1,
        settle=1,
        starts=1,
        tolerance=0.1,
        bracket=0.1,
        frequency=False,
        jobs=1,
    )
    coverage = life.coverage.values
    assert life.attrs["ending"] == "coverage"
    assert coverage[-1] < 0.6 + 1e-9 < coverage[0] == 0.9
    assert (np.diff(coverage) < 0.0).all()
    assert (life.attrs["mesh_cycles_direct"] > 0) == (energy != "10 J/m^2")
    loss = life.coverage_loss.values[0, 0] * float(energy.split()[0])
    assert abs(loss) == pytest.approx(0.9 * float(life.passage_adhesion_work.values[0, 0]), rel=1e-9)
