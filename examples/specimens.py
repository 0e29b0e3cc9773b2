"""
How much do gears of one design differ?
=======================================

On real asperities, few of which touch at a time, each gear has a surface of its own. Seeds number the surfaces; each
drawn pair of teeth is one specimen.
"""

import gearidae as gd

scene = gd.preset("teodorescu2009").replace(
    {
        "contact.roughness": "discrete",
        "mesh.radius_force": True,
        "run.duration": "0.2 ms",
        "run.samples": 2001,
    }
)
pulls = gd.studies.pull_off(scene, 200)
print(pulls.pull_off.to_series().mul(1e9).describe().round(1).to_string())  # nN

# %%
# Most pairs part with the pull-off force of a single coated asperity; a few have two that hold at the same time.

ax = gd.plot.pull_off(pulls)

# %%
# One specimen at work: each asperity that joins or detaches is an event.

ax = gd.plot.asperity_events(gd.simulate(scene))
