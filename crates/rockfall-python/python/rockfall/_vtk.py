"""Simulations as data sets of PyVista."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    import pyvista

    from rockfall._simulation import Simulation


def _lines(pairs: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """Cells of two points in the form that VTK reads: the number of points, then the points."""
    return np.insert(pairs, 0, 2, axis=1).ravel()


def to_pyvista(sim: Simulation) -> pyvista.PolyData:
    import pyvista

    spheres, rods, springs = (sim.table(kind) for kind in ("sphere", "rod", "spring"))
    pairs = np.concatenate(
        [np.stack([rods["end1"], rods["end2"]], axis=1), np.stack([springs["a"], springs["b"]], axis=1)]
    )
    count = len(spheres)
    cells = np.stack([np.ones(count, dtype=np.int64), np.arange(count)], axis=1).ravel()
    data = pyvista.PolyData(sim.positions.copy(), verts=cells, lines=_lines(pairs))
    data.cell_data["kind"] = np.repeat(np.arange(3, dtype=np.uint8), [count, len(rods), len(springs)])
    data.point_data["id"] = spheres["id"]
    for name, array in {
        "radius": sim.radii,
        "mass": sim.masses,
        "velocity": sim.velocities,
        "orientation": sim.orientations,
        "angular_momentum": sim.angular_momenta,
        "force": sim.external_forces,
    }.items():
        data.point_data[name] = array.copy()
    data.field_data["time"] = [sim.time]
    data.field_data["step"] = [sim.steps]
    return data
