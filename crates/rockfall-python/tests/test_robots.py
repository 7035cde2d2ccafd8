"""Robots from files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import rockfall as rf

URDF = """
<robot name="door">
  <link name="world"/>
  <link name="door">
    <inertial><origin xyz="0.5 0 0"/><mass value="20"/><inertia ixx="7" iyy="8" izz="1.7"/></inertial>
    <collision><origin xyz="0.5 0 0"/><geometry><box size="0.9 0.04 2"/></geometry></collision>
  </link>
  <joint name="hinge" type="revolute">
    <parent link="world"/><child link="door"/><axis xyz="0 0 1"/><limit lower="0" upper="1.5" effort="10" velocity="1"/>
  </joint>
</robot>"""
MJCF = """
<mujoco>
  <option gravity="0 0 -9.81"/>
  <worldbody>
    <geom type="plane" size="5 5 0.1"/>
    <body name="ball" pos="0 0 1"><freejoint/><geom type="sphere" size="0.25" mass="3"/></body>
  </worldbody>
</mujoco>"""


def test_a_urdf_file_becomes_bodies_and_joints(tmp_path: Path) -> None:
    path = tmp_path / "door.urdf"
    path.write_text(URDF)
    with pytest.warns(UserWarning, match="door.urdf"):
        scene = rf.load_urdf(path)
    sim = rf.Simulation(scene, backend="cpu")
    assert (sim.counts.bodies, sim.joints.names) == (1, ["hinge"])
    np.testing.assert_allclose(sim.bodies.positions, [[0.5, 0, 0]], atol=1e-6)
    sim.set_joints([0], speed=1.0, max_force=100.0)
    sim.run(30)
    assert 0.4 < sim.joints.positions[0] < 0.55


def test_an_mjcf_file_has_its_floor(tmp_path: Path) -> None:
    path = tmp_path / "ball.xml"
    path.write_text(MJCF)
    sim = rf.Simulation(rf.load_mjcf(path), backend="cpu")
    sim.run(120)
    assert sim.bodies.positions[0, 2] == pytest.approx(0.25, abs=1e-3)


def test_wrong_files_are_named(tmp_path: Path) -> None:
    path = tmp_path / "wrong.urdf"
    path.write_text('<robot name="r">\n<link name="a"><inertial><mass value="x"/></inertial></link>\n</robot>')
    with pytest.raises(ValueError, match=r"wrong\.urdf:2"):
        rf.load_urdf(path)
    with pytest.raises(OSError, match=r"missing\.xml"):
        rf.load_mjcf(tmp_path / "missing.xml")
