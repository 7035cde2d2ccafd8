"""Data sets of PyVista."""

from __future__ import annotations

import sys

import numpy as np
import pytest
import pyvista

import rockfall as rf


def test_a_data_set_has_the_state_of_every_sphere_and_the_bonds(sim: rf.Simulation) -> None:
    sim.run(20)
    data = sim.to_pyvista()
    assert (data.n_points, data.n_verts, data.n_lines) == (45, 45, 4)
    np.testing.assert_array_equal(data.points, sim.positions)
    for name, array in {"radius": sim.radii, "mass": sim.masses, "velocity": sim.velocities, "id": sim.sphere_ids}.items():
        np.testing.assert_array_equal(data.point_data[name], array)
    assert data.cell_data["kind"].tolist() == [0] * 45 + [1] * 2 + [2] * 2
    assert data.lines.reshape(-1, 3).tolist() == [[2, 40, 41], [2, 41, 42], [2, 42, 43], [2, 43, 44]]
    assert data.field_data["step"].tolist() == [20]
    balls = data.glyph(geom=pyvista.Sphere(radius=1.0), scale="radius", orient=False)
    assert balls.bounds[3] == pytest.approx((sim.positions[:, 1] + sim.radii).max(), abs=0.05)
    before = data.points.copy()
    sim.run(20)
    np.testing.assert_array_equal(data.points, before)


def test_without_pyvista_the_error_names_it(sim: rf.Simulation, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(ImportError, match="pyvista"):
        sim.to_pyvista()
