"""The dataset: layout, units, provenance, and how the runs of a sweep are stacked."""

from __future__ import annotations

import itertools
import json
from dataclasses import fields

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.archive import combine, dimension_names, to_dataset
from gearidae.archive.select import run_value, runs
from gearidae.archive.variables import EVENTS, SAMPLES
from gearidae.records import (
    ELASTIC_COLUMNS,
    GEAR_COLUMNS,
    POPULATION_COLUMNS,
    ROLLER_COLUMNS,
    EventKind,
    Statistics,
)
from gearidae.records.columns import JOINT_FRICTION_COLUMNS, JOINT_LOAD_COLUMNS, LAW_SAMPLES
from gearidae.records.energy import TERMS
from gearidae.runs.running import unsolved

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.samples": 101})
ROLLER = gd.preset("roller_slow").replace({"run.samples": 51})

# The layout that users' scripts rely on, written out: name, dimension, unit.
GEAR_LAYOUT = {
    "reached": ("s",),
    "gear_speed": ("time", "rad s-1"),
    "pinion_speed": ("time", "rad s-1"),
    "gear_angle": ("time", "rad"),
    "transmission_error": ("time", "m"),
    "mesh_force": ("time", "N"),
    "gear_contact_torque": ("time", "N m"),
    "drive_gap": ("time", "m"),
    "coast_gap": ("time", "m"),
    "pairs_in_contact": ("time", "1"),
    "drive_torque": ("time", "N m"),
    "load_torque": ("time", "N m"),
    "pinion_angle": ("time", "rad"),
    "event_time": ("event", "s"),
    "event_kind": ("event", "1"),
    "event_pair": ("event", "1"),
    "event_flank": ("event", "1"),
    "event_gap_rate": ("event", "m s-1"),
    "event_force": ("event", "N"),
    "event_sam_fraction": ("event", "1"),
    **{f"passage_{name}": ("passage", "1") for name in ("pair", "tooth", "flank", "impacts", "sam_fraction")},
    "passage_time": ("passage", "s"),
    "passage_largest_force": ("passage", "N"),
    "passage_smallest_force": ("passage", "N"),
    **{f"passage_{name}": ("passage", "J") for name in TERMS},
}
ROLLER_LAYOUT = {
    "reached": ("s",),
    "height": ("time", "m"),
    "speed": ("time", "m s-1"),
    "force": ("time", "N"),
}


def layout_of(ds: xr.Dataset) -> dict[str, tuple[str, str]]:
    return {
        str(name): (*map(str, variable.dims), variable.attrs["units"])
        for name, variable in ds.data_vars.items()
    }


def test_catalogue_knows_every_column_of_the_engine():
    columns = (
        *(GEAR_COLUMNS, ROLLER_COLUMNS, ELASTIC_COLUMNS, POPULATION_COLUMNS),
        *(JOINT_LOAD_COLUMNS, JOINT_FRICTION_COLUMNS, [column.name for column in LAW_SAMPLES]),
    )
    assert set(SAMPLES) == {name for names in columns for name in names}


def test_gear_run_has_the_promised_layout(make_solution):
    solution = make_solution(LOW)
    ds = to_dataset(LOW, solution)
    assert layout_of(ds) == GEAR_LAYOUT
    for name in GEAR_COLUMNS:
        assert np.array_equal(ds[name], solution.samples[name])
    assert ds.sam_fraction.item() == 1.0
    assert ds.sam_fraction.dims == ()
    assert ds.time.dtype == np.float64
    assert ds.time.attrs["units"] == "s"


def test_roller_run_has_the_promised_layout(make_solution):
    ds = to_dataset(ROLLER, make_solution(ROLLER))
    events = {name: entry for name, entry in GEAR_LAYOUT.items() if name.startswith("event_")}
    assert layout_of(ds) == ROLLER_LAYOUT | events
    assert ds.sam_fraction.item() == 0.0


def test_every_variable_says_what_it_is(make_solution):
    ds = combine(LOW, {"coating.sam_fraction": [1.0]}, [LOW], [make_solution(LOW)])
    for variable in ds.variables.values():
        assert variable.attrs["long_name"]
        assert variable.attrs["units"]


def test_flags_follow_cf(make_solution):
    ds = to_dataset(LOW, make_solution(LOW))
    kind, flank = ds.event_kind.attrs, ds.event_flank.attrs
    assert kind["flag_meanings"].split() == [
        "onset", "separation", "turning_point", "full_stretch", "mesh_entry",
        "mesh_exit", "stick", "slip", "flank_change", "schedule_knot", "asperity_onset",
        "asperity_detachment", "sliding_reversal", "flank_stick", "flank_slip",
        "pinion_spring_contact", "gear_spring_contact", "pinion_spring_release", "gear_spring_release",
    ]  # fmt: skip
    assert kind["flag_values"].tolist() == list(range(19))
    assert flank["flag_meanings"].split() == ["none", "drive", "coast"]
    assert flank["flag_values"].tolist() == [-1, 0, 1]
    for name in ("event_kind", "event_flank"):  # CF: flag values have the variable's own type
        assert ds[name].attrs["flag_values"].dtype == ds[name].dtype == np.int8


def test_provenance(make_solution):
    scene = LOW.replace({"run.rtol": 3e-7})
    attributes = to_dataset(scene, make_solution(scene)).attrs
    assert attributes["Conventions"] == "CF-1.11, ACDD-1.3"
    for name in ("title", "summary", "history", "source", "references", "license", "date_created"):
        assert attributes[name]
    assert gd.__version__ in attributes["source"]
    assert "SUNDIALS" in attributes["source"]
    assert "10.1016/j.triboint.2008.05.019" in attributes["references"]
    assert attributes["rtol"] == 3e-7
    assert attributes["t_end"] == scene.run.duration
    assert gd.Scene.from_dict(json.loads(attributes["scene"])) == scene
    # The bare preset lies at the edge of JKR, the coated one far below it.
    assert attributes["tabor_parameter_bare"] == pytest.approx(5.0, rel=1e-2, abs=0)
    assert attributes["tabor_parameter_coated"] == pytest.approx(0.82, rel=1e-2, abs=0)
    assert attributes["tabor_regime_bare"] == "jkr"
    assert attributes["tabor_regime_coated"] == "transition"


def test_statistics_are_attributes(make_solution):
    solution = make_solution(LOW)
    attributes = to_dataset(LOW, solution).attrs
    for field in fields(Statistics):
        if field.name not in (
            "skipped",
            "flight_steps",
            "ending",
            "fold_gap",
        ):  # follow from skipped and status
            assert attributes[field.name] == getattr(solution.statistics, field.name)
    assert json.loads(attributes["skipped"]) == {"coast_flank": 1}
    assert (attributes["status"], attributes["message"]) == ("finished", "")


def test_two_runs_differ_in_date_only(make_solution):
    first, second = (to_dataset(LOW, make_solution(LOW)) for _ in range(2))
    for ds in (first, second):
        for name in ("history", "date_created"):
            del ds.attrs[name]
    xr.testing.assert_identical(first, second)


def test_sweep_stacks_runs_in_order(make_solution):
    fractions = [1.0, 0.5, 0.45]
    scenes = [LOW.replace({"coating.sam_fraction": fraction}) for fraction in fractions]
    solutions = [make_solution(scene, impacts=count) for scene, count in zip(scenes, (4, 0, 2), strict=True)]
    ds = combine(LOW, {"coating.sam_fraction": fractions}, scenes, solutions)
    assert ds.gear_speed.dims == ("sam_fraction", "time")
    assert ds.sam_fraction.values.tolist() == fractions
    for fraction, solution in zip(fractions, solutions, strict=True):
        for name in GEAR_COLUMNS:
            assert np.array_equal(ds[name].sel(sam_fraction=fraction), solution.samples[name])
    # Ragged events: 8, none and 4 of them.
    assert ds.event_sam_fraction.values.tolist() == [1.0] * 8 + [0.45] * 4
    assert ds.event_kind.dtype == np.int8
    assert ds.steps.values.tolist() == [100, 100, 100]
    assert ds.attrs["steps"] == 300
    assert ds.attrs["wall_time"] == pytest.approx(0.75)
    assert ds.attrs["status"] == "finished"


def test_runs_of_a_sweep_are_the_single_runs(make_solution):
    fractions = [1.0, 0.5]
    scenes = [LOW.replace({"coating.sam_fraction": fraction}) for fraction in fractions]
    solutions = [make_solution(scene) for scene in scenes]
    ds = combine(LOW, {"coating.sam_fraction": fractions}, scenes, solutions)
    for scene, solution, (label, run) in zip(scenes, solutions, runs(ds), strict=True):
        single = to_dataset(scene, solution)
        assert label == {"sam_fraction": scene.coating.sam_fraction}
        for name in (*GEAR_COLUMNS, *EVENTS):
            xr.testing.assert_equal(run[name].variable, single[name].variable)
        assert run_value(run, "steps") == run_value(single, "steps")
        assert run_value(run, "status") == "finished"


def test_product_of_two_keys(make_solution):
    swept = {"coating.sam_fraction": [1.0, 0.5], "drive.torque": [1e-18, 2e-18, 3e-18]}
    scenes = [LOW.replace(dict(zip(swept, pair, strict=True))) for pair in itertools.product(*swept.values())]
    solutions = [make_solution(scene, impacts=number) for number, scene in enumerate(scenes)]
    ds = combine(LOW, swept, scenes, solutions)
    assert ds.gear_speed.dims == ("sam_fraction", "torque", "time")
    assert ds.torque.attrs["units"] == "N m"
    for number, (fraction, torque) in enumerate(itertools.product(*swept.values())):
        of_run = (ds.event_sam_fraction == fraction) & (ds.event_torque == torque)
        assert of_run.sum() == 2 * number
        chosen = ds.gear_speed.sel(sam_fraction=fraction, torque=torque)
        assert np.array_equal(chosen, solutions[number].samples["gear_speed"])


def test_runs_that_end_early_are_nan_from_there_on(make_solution):
    fractions = [1.0, 0.5, 0.4]
    scenes = [LOW.replace({"coating.sam_fraction": fraction}) for fraction in fractions]
    solutions = [
        make_solution(scenes[0]),
        make_solution(scenes[1], reached=0.3, status="chatter"),
        unsolved("failed", "no consistent start"),
    ]
    ds = combine(LOW, {"coating.sam_fraction": fractions}, scenes, solutions)
    assert np.isfinite(ds.gear_speed.values).sum(axis=1).tolist() == [101, 30, 0]
    assert ds.status.values.tolist() == ["finished", "chatter", "failed"]
    assert ds.message.values.tolist() == ["", "it ended: chatter", "no consistent start"]
    assert ds.attrs["status"] == "partial"
    assert ds.attrs["message"] == "1 of 3 runs finished"
    assert set(ds.event_sam_fraction.values) == {1.0, 0.5}


def test_words_and_lists_as_swept_values(make_solution):
    harmonics = [[], [{"amplitude": 1e-19, "frequency": 10.0, "phase": 0.0}]]
    swept = {"contact.bodies": ["rigid", "elastic"], "drive.harmonic": harmonics}
    scenes = [LOW.replace(dict(zip(swept, pair, strict=True))) for pair in itertools.product(*swept.values())]
    ds = combine(LOW, swept, scenes, [make_solution(scene) for scene in scenes])
    assert ds.bodies.values.tolist() == ["rigid", "elastic"]
    assert set(ds.event_bodies.values.tolist()) == {"rigid", "elastic"}
    assert ds.harmonic.values.tolist() == [0, 1]
    assert json.dumps(harmonics) in ds.harmonic.attrs["comment"]
    assert ds.sam_fraction.item() == 1.0


@pytest.mark.parametrize(
    ("keys", "names"),
    [
        (["coating.sam_fraction"], ["sam_fraction"]),
        (["mesh.backlash", "drive.torque"], ["backlash", "torque"]),
        (["drive.torque", "load.torque"], ["swept_drive_torque", "swept_load_torque"]),
        (["surface.energy", "coating.energy"], ["surface_energy", "coating_energy"]),
        (["roller.speed"], ["roller_speed"]),  # speed is a variable of the dataset
        (["initial.gear_speed"], ["initial_gear_speed"]),
    ],
)
def test_names_of_dimensions_never_collide(keys, names):
    assert list(dimension_names(keys).values()) == names


def test_events_of_other_runs_stay_out_of_a_selection(make_solution):
    fractions = [1.0, 0.5]
    scenes = [LOW.replace({"coating.sam_fraction": fraction}) for fraction in fractions]
    solutions = [make_solution(scene, impacts=count) for scene, count in zip(scenes, (1, 4), strict=True)]
    ds = combine(LOW, {"coating.sam_fraction": fractions}, scenes, solutions)
    ((_, run),) = runs(ds.sel(sam_fraction=0.5))
    assert (run.event_kind == EventKind.ONSET).sum() == 4
    assert run.sizes["passage"] == 4
    assert (run.passage_sam_fraction == 0.5).all()


def test_rows_that_xarray_has_repeated_for_each_run_are_refused_by_name(make_solution):
    fractions = [1.0, 0.5]
    scenes = [LOW.replace({"coating.sam_fraction": fraction}) for fraction in fractions]
    solutions = [make_solution(scene, impacts=2) for scene in scenes]
    ds = combine(LOW, {"coating.sam_fraction": fractions}, scenes, solutions)
    with pytest.raises(gd.SceneError, match=r"event_sam_fraction .*must lie along event alone; where\(\)"):
        list(runs(ds.where(ds.sam_fraction > 0.4, drop=True)))
