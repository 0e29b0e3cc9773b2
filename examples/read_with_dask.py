"""
How do I read archives that are larger than memory?
===================================================

An archive is a netCDF4 file. With ``chunks={}`` xarray leaves it on the disk, and Dask works through it piece by piece
(``pip install "gearidae[dask]"``).
"""

import numpy as np
import xarray as xr

import gearidae as gd
from gearidae.records import EventKind, Flank

scene = gd.preset("teodorescu2009_low_speed")
gd.sweep(scene, {"coating.sam_fraction": [1.0, 0.6, 0.5]}, archive="sweep.nc", overwrite=True)

with xr.open_dataset("sweep.nc", chunks={}) as ds:
    late = ds.sel(time=slice(0.1, None))
    table = xr.Dataset(
        {
            "mean speed": late.gear_speed.mean("time"),
            "ripple": late.gear_speed.std("time"),
            "pulled back": (late.gear_contact_torque < 0.0).mean("time"),  # share of the time
        }
    ).compute()  # nothing has been read until here
    print(table.to_dataframe().round(4))

    # events lie on one dimension of their own, labelled by the run they belong to
    exit_of_drive = (ds.event_kind == EventKind.MESH_EXIT) & (ds.event_flank == Flank.DRIVE)
    exits = ds.event_time.where(exit_of_drive).compute()
    for fraction in ds.sam_fraction.values:
        times = exits.where(ds.event_sam_fraction == fraction).dropna("event").values
        apart = np.diff(times).mean() * 1e3
        print(f"SAM {fraction:g}: a tooth leaves every {apart:.1f} ms on average")

# %%
# Of a picture only the samples that it shows are read.

with gd.open("sweep.nc") as ds:
    ax = gd.plot.gear_speed(ds)
