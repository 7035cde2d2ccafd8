"""Data sets of PyVista."""

from __future__ import annotations

import pathlib
import sys
from collections.abc import Callable

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


def test_fields_are_those_of_the_command_line(tmp_path: pathlib.Path, command_line: Callable[..., str]) -> None:
    scene = rf.Scene()
    scene.settings.update(contact_law="hertz-mindlin", gravity=10)
    scene.add_material("m", density=1, young=1e5, poisson=0.25)
    scene.set_pair("m", "m", restitution=0.3, friction=0.4)
    scene.add_box([-2, -1, -2], [2, 0, 2], material="m")
    scene.add_spheres([[0, y, 0] for y in (0.5, 1.5, 2.5)], 0.5, mass=None, material="m")
    sim = rf.Simulation(scene, dt=1e-4, backend="cpu")
    sim.run(20_000)
    fields = sim.fields(0.5, spacing=0.2)
    weight = 10 * sim.masses.sum()
    assert fields.density.sum() * 0.2**3 == pytest.approx(sim.masses.sum(), rel=0.01)
    assert fields.wall_force.sum(axis=(0, 1, 2))[1] * 0.2**3 == pytest.approx(weight, rel=0.01)
    middle = np.abs(fields.points[..., [0, 2]]).max(axis=-1) < 0.11
    assert fields.stress[middle][:, 1, 1].min() < 0 and fields.pressure.shape == fields.density.shape
    np.testing.assert_allclose(fields.stress, fields.contact_stress + fields.kinetic_stress)
    sim.save_checkpoint(tmp_path / "column.ckpt")
    for name in ("column.vti", "column.npz"):
        command_line("fields", tmp_path / "column.ckpt", "--width", 0.5, "--spacing", 0.2, "--out", tmp_path / name)
    image, arrays = pyvista.read(tmp_path / "column.vti"), np.load(tmp_path / "column.npz")
    assert image.spacing == pytest.approx((0.2, 0.2, 0.2)) and image.origin == pytest.approx(tuple(fields.origin))
    for name in ("density", "velocity", "pressure", "temperature", "stress", "wall_force"):
        expected = getattr(fields, name)
        np.testing.assert_array_equal(arrays[name], expected)
        np.testing.assert_array_equal(np.reshape(image.point_data[name], expected.shape), expected)
    with pytest.raises(ValueError, match="width: -1 is not allowed"):
        sim.fields(-1)
    with pytest.raises(TypeError, match="width: expected a number, got str"):
        sim.fields("1")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="expected gaussian or heaviside"):
        sim.fields(kernel="gauss")


def test_without_pyvista_the_error_names_it(sim: rf.Simulation, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(ImportError, match="pyvista"):
        sim.to_pyvista()
