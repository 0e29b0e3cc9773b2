"""One gear pair: geometry of the mesh, and its friction in closed form (`friction`), on plain numbers in SI units."""

from gearidae.mesh.involute import (
    Geometry,
    GeometryError,
    check_geometry,
    curvature_radii,
    flank_arc,
    mesh_geometry,
    position_of_arc,
    separation,
)

__all__ = [
    "Geometry",
    "GeometryError",
    "check_geometry",
    "curvature_radii",
    "flank_arc",
    "mesh_geometry",
    "position_of_arc",
    "separation",
]
