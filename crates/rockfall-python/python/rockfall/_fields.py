"""Coarse-grained fields."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True, eq=False, repr=False)
class Fields:
    """Density, velocity, stress and temperature on a grid of points (:meth:`Simulation.fields`).

    All arrays are float64 with the first axes Z, Y, X: ``density[k, j, i]`` is the density at
    ``origin + spacing * numpy.array([i, j, k])``. Stress is positive in tension; ``stress[..., i, j]`` is the force in the direction
    j per area of a face whose normal is the axis i. Where there is no body, fields are 0.
    """

    #: The first point, in units; shape (3,).
    origin: npt.NDArray[np.float64]
    #: Distance between points, in units.
    spacing: float
    #: Density, in mass/units³; shape (Z, Y, X).
    density: npt.NDArray[np.float64]
    #: Velocity, in units/s; shape (Z, Y, X, 3).
    velocity: npt.NDArray[np.float64]
    #: A third of the trace of the stress, positive in compression, in mass/(units s²); shape (Z, Y, X).
    pressure: npt.NDArray[np.float64]
    #: Mean square of a component of the velocity relative to :attr:`velocity`, in units²/s²; shape (Z, Y, X).
    temperature: npt.NDArray[np.float64]
    #: Contact and kinetic stress together, in mass/(units s²); shape (Z, Y, X, 3, 3).
    stress: npt.NDArray[np.float64]
    #: Stress that contacts transmit, in mass/(units s²); shape (Z, Y, X, 3, 3).
    contact_stress: npt.NDArray[np.float64]
    #: Stress by the motion relative to :attr:`velocity`, in mass/(units s²); shape (Z, Y, X, 3, 3).
    kinetic_stress: npt.NDArray[np.float64]
    #: Force density of boxes, polygons and fixed bodies, in mass/(units² s²); shape (Z, Y, X, 3).
    wall_force: npt.NDArray[np.float64]

    def __repr__(self) -> str:
        z, y, x = self.density.shape
        return f"<rockfall.Fields: {x} x {y} x {z} points from {self.origin.tolist()}, spacing {self.spacing:g}>"

    @property
    def points(self) -> npt.NDArray[np.float64]:
        """The points, in units; shape (Z, Y, X, 3)."""
        z, y, x = np.indices(self.density.shape)
        found: npt.NDArray[np.float64] = self.origin + self.spacing * np.stack([x, y, z], axis=-1)
        return found
