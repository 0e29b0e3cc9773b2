"""What a user describes: a frozen, validated scene, its presets and its case files."""

from gearidae.scene.case import load_case
from gearidae.scene.coating import MATERIAL_NAMES, Coating, Material
from gearidae.scene.dump import dump_case, dump_keys
from gearidae.scene.gears import Gears, Mesh, Runout, StaticErrorHarmonic
from gearidae.scene.keys import KeyInfo
from gearidae.scene.knots import Knots
from gearidae.scene.presets import PRESETS, preset
from gearidae.scene.run import Initial, Roller, Run
from gearidae.scene.scene import (
    GearScene,
    RollerScene,
    Scene,
    TrainScene,
    describe_key,
    describe_keys,
    is_long_train,
    require_gears,
    require_meshes,
)
from gearidae.scene.scene_display import differences, nearest_preset
from gearidae.scene.shafts import Meshing, Shaft
from gearidae.scene.surface import Contact, Surface
from gearidae.scene.torque import Drive, Harmonic, Load

__all__ = [
    "MATERIAL_NAMES",
    "PRESETS",
    "Coating",
    "Contact",
    "Drive",
    "GearScene",
    "Gears",
    "Harmonic",
    "Initial",
    "KeyInfo",
    "Knots",
    "Load",
    "Material",
    "Mesh",
    "Meshing",
    "Roller",
    "RollerScene",
    "Run",
    "Runout",
    "Scene",
    "Shaft",
    "StaticErrorHarmonic",
    "Surface",
    "TrainScene",
    "describe_key",
    "describe_keys",
    "differences",
    "dump_case",
    "dump_keys",
    "is_long_train",
    "load_case",
    "nearest_preset",
    "preset",
    "require_gears",
    "require_meshes",
]
