"""A surface for tests: any object with these six names will do."""

from dataclasses import dataclass


@dataclass(frozen=True)
class PlainSurface:
    """Bare silicon, rough by 6 nm unless the arguments say otherwise."""

    youngs_modulus: float = 161e9
    poisson_ratio: float = 0.23
    energy: float = 1.5
    asperity_density: float = 1.69e14
    asperity_radius: float = 450e-9
    roughness: float = 6e-9
