"""Small oscillations of a train about its pressed contacts."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gearidae.arrays import Floats
from gearidae.mesh.pair_contact import pair_contact

if TYPE_CHECKING:
    from gearidae.scene import TrainScene
    from gearidae.scene.train import Train


def levers(train: Train) -> Floats:
    """Change of each mesh's transmission error with the angle of each shaft, shape (meshes, shafts) [m]."""
    arms = np.zeros((len(train.meshes), len(train.shafts)))
    for row, mesh in zip(arms, train.meshes, strict=True):
        row[mesh.a] = mesh.geometry.base_radius_pinion
        row[mesh.b] = -mesh.geometry.base_radius_gear
    return arms


def natural_frequencies(scene: TrainScene, forces: Floats) -> list[float]:
    """Frequencies of small oscillations [Hz], rising, with one pair at the pitch point in every mesh that is pressed.

    See `frequencies_at`.
    """
    train = scene.train
    stiffness = np.zeros(len(train.meshes))
    for number, (mesh, force) in enumerate(zip(train.meshes, forces, strict=True)):
        contact = pair_contact(scene.pair(mesh.name))
        gap = contact.resting_gap(float(force))
        stiffness[number] = 0.0 if math.isnan(gap) else max(contact.stiffness(gap), 0.0)
    return frequencies_at(train, stiffness)


def frequencies_at(train: Train, stiffness: Floats) -> list[float]:
    """Frequencies of small oscillations [Hz], rising, by the stiffness of each mesh [N/m], 0 where it does not carry.

    Square roots of the eigenvalues of ``J I^-1 J' K``, with the levers J, inertias I and stiffnesses K of the meshes.
    """
    scaled = levers(train) / np.sqrt([shaft.inertia for shaft in train.shafts])
    roots = np.sqrt(stiffness)
    squares = np.linalg.eigvalsh(roots[:, None] * (scaled @ scaled.T) * roots)
    independent = len(train.shafts) - 1  # of more meshes the rest follow
    pressed = min(independent, int(np.count_nonzero(stiffness)))
    return [math.sqrt(max(square, 0.0)) / (2.0 * math.pi) for square in squares[len(squares) - pressed :]]
