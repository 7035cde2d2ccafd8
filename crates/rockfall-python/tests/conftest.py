"""Scenes and programs that tests share."""

from __future__ import annotations

import os
import pathlib
import subprocess
from collections.abc import Callable

import numpy as np
import pytest

import rockfall as rf

ROOT = pathlib.Path(__file__).resolve().parents[3]


@pytest.fixture
def scene() -> rf.Scene:
    """A floor, forty balls in four layers, and a chain of five balls with rods and springs."""
    scene = rf.Scene()
    scene.add_box([-5, -1, -5], [5, 0, 5])
    grid = np.stack(np.meshgrid(np.arange(5), np.arange(1, 5), np.arange(2), indexing="ij"), -1).reshape(-1, 3)
    balls = scene.add_spheres(grid * 0.9, radius=0.4, mass=np.linspace(1, 2, 40), velocity=[0.1, 0, 0.05])
    chain = scene.add_spheres(np.arange(5)[:, None] * [0.5, 0, 0] + [0, 6, 0], radius=0.1)
    scene.add_rods(chain[:2], chain[1:3], radius=0.05, length=0.5)
    scene.add_springs(chain[2:-1], chain[3:], stiffness=20, damping=0.5)
    scene.add_tethers(chain[0], [0, 7, 0], stiffness=30)
    assert len(balls) == 40
    return scene


@pytest.fixture
def sim(scene: rf.Scene) -> rf.Simulation:
    """A simulation of the scene on the CPU."""
    return rf.Simulation(scene, dt=0.01, backend="cpu")


@pytest.fixture(scope="session")
def command_line() -> Callable[..., str]:
    """Runs the program ``rockfall``, whose path is in ROCKFALL_BIN (scripts/test-python sets it)."""
    program = os.environ.get("ROCKFALL_BIN")
    assert program, "set ROCKFALL_BIN to the path of the program rockfall, or use scripts/test-python"

    def run(*arguments: object) -> str:
        done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run
