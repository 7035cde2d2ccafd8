"""What type checkers find in programs that use the package."""

from __future__ import annotations

import pathlib
import subprocess
import sys

import pytest

PROGRAM = """
import rockfall as rf

scene = rf.Scene()
scene.settings.gravity = 9.81
scene.settings.contact_law = "hertz-mindlin"
scene.settings.contact_law = "hertz"  # wrong
scene.settings.gravity = "9.81"  # wrong
scene.settings.gravty = 9.81  # wrong
scene.settings.update(gravity=9.81, precision="double")
scene.settings.update(gravty=9.81)  # wrong
scene.gravity = 9.81  # wrong
ball = scene.add_sphere([0, 1, 0], 0.1, group=3, fixed=True)
scene.add_sphere([0, 1, 0], 0.1, color="red")  # wrong
scene.add_box([0, 0, 0], [1, 1, 1], group=2)
scene.add_box([0, 0, 0], [1, 1, 1], fixed=True)  # wrong
scene.add_box([0, 0, 0], [1, 1, 1], look="glass")
scene.add_box([0, 0, 0], [1, 1, 1], look="marble")  # wrong
scene.add_rod(0, 1, 0.1, length=1.0, group=1)
scene.add_spring(0, 1, 5.0, muscles=1)  # wrong
scene.set_pair("a", "a", rolling_model="c", cohesion="jkr")
scene.set_pair("a", "a", rolling_model="b")  # wrong
scene.table("rod")
scene.table("rods")  # wrong
scene.remove("box", 0)
scene.remove("ball", 0)  # wrong
backend: rf.typing.BackendName = "cpu"
sim = rf.Simulation(scene, backend=backend, integrator="rk4")
rf.Simulation(scene, backend="cuda")  # wrong
rf.Simulation(scene, integrator="euler")  # wrong
rf.Simulation(scene, broad_phase="tree")  # wrong
sim.velocity = 0  # wrong
sim.velocities[:] = 0
sim.render(colour_by="speed")
sim.render(colour_by="colour")  # wrong
sim.fields(kernel="box")  # wrong
twin: rf.Simulation = sim.copy()
worlds = rf.Worlds(scene, count=2)
worlds.record(5, field="positions")
worlds.record(5, field="position")  # wrong
worlds.render(0, colour_by="speed")
worlds.render(0, color_by="speed")  # wrong
rf.evolve(1, 4, seed=1, goal="distance")
rf.evolve(1, 4, sed=1)  # wrong
rf.gym.make_vec(num_envs=2, frame_skip=3)
rf.gym.make_vec(num_envs=2, frameskip=3)  # wrong
rf.gym.make(max_step=3)  # wrong
frame: rf.Frame = rf.Trajectory("a.npz")[0]
part: rf.Trajectory = rf.Trajectory("a.npz")[1:]
"""


def test_a_type_checker_finds_wrong_names(tmp_path: pathlib.Path) -> None:
    pytest.importorskip("mypy")
    (tmp_path / "program.py").write_text(PROGRAM)
    command = [sys.executable, "-m", "mypy", "--cache-dir", str(tmp_path / "cache"), "program.py"]
    found = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    lines = {int(line.split(":")[1]) for line in found.stdout.splitlines() if ": error:" in line}
    wrong = {number for number, line in enumerate(PROGRAM.splitlines(), 1) if line.endswith("# wrong")}
    assert lines == wrong, found.stdout + found.stderr
