"""Adhesion of a hub: a journal in its bore is a cylinder on a plane."""

import numpy as np
import pytest

import gearidae as gd

PRESET = gd.preset("teodorescu2009")
HUB = ("3 um", "0.5 um", "2 um")


@pytest.mark.parametrize(
    ("changes", "low", "high"),
    [
        ({"coating.sam_fraction": 1.0}, 4.2e-7, 1.2e-6),
        ({"coating.sam_fraction": 0.0}, 6e-6, 7e-5),
        (
            {"coating.sam_fraction": 0.0, "surface.asperity_radius": 160e-9, "surface.energy": 0.04},
            3e-8,
            2e-7,
        ),
    ],
)
def test_a_coated_hub_clings_much_less_than_a_bare_one(changes, low, high):
    """From one asperity's pull-off, 1.5 pi w beta of JKR, to that of some of them."""
    scene = PRESET.replace(changes)
    ds = gd.contact.hub_adhesion(scene, *HUB, load="10 uN", seeds=20)
    assert low < float(ds.pull_off.min()) <= float(ds.pull_off.max()) < high
    surface = scene.coated_surface if scene.coating.sam_fraction == 1.0 else scene.surface
    of_one = 1.5 * np.pi * 2.0 * surface.energy * surface.asperity_radius
    assert float(ds.pull_off.min()) == pytest.approx(of_one, rel=0.01, abs=0)


def test_it_is_the_pull_off_of_a_roller_of_the_reduced_radius():
    surfaces = {name: PRESET.to_dict()[name] for name in ("surface", "coating")}
    radius = 3e-6 * 3.5e-6 / 0.5e-6
    roller = {"radius": radius, "width": 2e-6, "mass": 1e-12, "speed": 1e-2, "height": 4e-8}
    scene = gd.Scene.from_dict({**surfaces, "roller": roller, "run": {"duration": 1e-6}})
    expected = gd.studies.pull_off(scene, 5, load=1e-5)
    hub = gd.contact.hub_adhesion(PRESET, 3e-6, 0.5e-6, 2e-6, load=1e-5, seeds=5)
    np.testing.assert_allclose(hub.pull_off, expected.pull_off, rtol=1e-12)


@pytest.mark.parametrize(
    ("changes", "name"),
    [({"clearance": 0.0}, "clearance"), ({"radius": "3 s"}, "radius"), ({"load": -1.0}, "load")],
)
def test_what_is_no_size_is_named(changes, name):
    sizes = {"radius": "3 um", "clearance": "0.5 um", "width": "2 um", "load": "1 uN"}
    with pytest.raises(gd.SceneError, match=f"^{name}"):
        gd.contact.hub_adhesion(PRESET, **sizes | changes)
