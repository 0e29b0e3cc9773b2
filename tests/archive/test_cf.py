"""What CF asks of a file and can be tested without its checker: units, flags, coordinates, attributes."""

from __future__ import annotations

import re

import netCDF4
import numpy as np
import pytest

import gearidae as gd

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 1e-3, "run.samples": 11})
ELASTIC = gd.preset("roller_slow").replace(
    {"contact.bodies": "elastic", "run.duration": 1e-7, "run.samples": 11}
)
UNIT = re.compile(
    r"(1|(m|s|kg|N|J|Pa|Hz|rad|K)(\^?-?\d+)?([ /](m|s|kg|N|J|Pa|Hz|rad|K)(\^?-?\d+)?)*|1/m\^2|1/s)"
)
"""Units as UDUNITS reads them: SI symbols with powers, and at most one solidus before each."""


@pytest.fixture(scope="module", params=["single", "sweep", "zipped", "kept", "elastic"])
def file(request, tmp_path_factory):
    path = tmp_path_factory.mktemp("cf") / "file.nc"
    over = {"coating.sam_fraction": [1.0, 0.5], "drive.torque": [4e-18, 5e-18]}
    match request.param:
        case "single":
            gd.simulate(LOW, archive=path)
        case "elastic":
            gd.simulate(ELASTIC, archive=path)
        case "zipped":
            gd.sweep(LOW, over, archive=path, zipped=True)
        case "kept":
            gd.sweep(LOW, over, archive=path, keep=["extremes", "events"])
        case "sweep":
            gd.sweep(LOW, over, archive=path)
    with netCDF4.Dataset(path) as opened:
        yield opened


def test_every_variable_has_a_unit_of_udunits(file):
    for name, variable in file.variables.items():
        assert variable.long_name, name
        assert UNIT.fullmatch(variable.units), (name, variable.units)


def test_units_of_every_key_that_can_be_swept():
    for info in gd.describe_keys():
        if info.unit:
            assert UNIT.fullmatch(info.unit), (info.key, info.unit)


def test_coordinates_are_named_by_the_variables_that_have_them(file):
    for name, variable in file.variables.items():
        for coordinate in getattr(variable, "coordinates", "").split():
            assert coordinate in file.variables, name
            assert set(file[coordinate].dimensions) <= set(variable.dimensions), name
    if "gear_speed" in file.variables and "sam_fraction" not in file.dimensions:
        assert "sam_fraction" in file["gear_speed"].coordinates.split()


def test_coordinate_variables_have_no_gaps_and_no_order_broken(file):
    for name in file.dimensions:
        if name in file.variables:
            assert "_FillValue" not in file[name].ncattrs()
            assert len(np.unique(file[name][:])) == len(file[name][:])


def test_flags_have_a_meaning_for_each_value(file):
    flags = [flag for flag in file.variables.values() if "flag_meanings" in flag.ncattrs()]
    assert len(flags) == (3 if "passage" in file.dimensions else 2)
    for variable in flags:
        assert variable.flag_values.dtype == variable.dtype
        assert len(variable.flag_values) == len(variable.flag_meanings.split())
        assert set(np.unique(variable[:])) <= set(variable.flag_values.tolist())


def test_global_attributes(file):
    assert "CF-1.11" in file.Conventions
    for name in ("title", "history", "source", "references", "summary", "license"):
        assert getattr(file, name)
    assert all(re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name) for name in (*file.ncattrs(), *file.variables))
