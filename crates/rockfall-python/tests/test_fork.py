"""Processes that were forked."""

from __future__ import annotations

import subprocess
import sys

import pytest

SETUP = """
import multiprocessing, warnings
import numpy as np
import rockfall as rf

warnings.simplefilter("ignore")

def column():
    scene = rf.Scene()
    scene.add_box([-5, -1, -5], [5, 0, 5])
    scene.add_spheres(np.arange(300)[:, None] * [0.001, 0.25, 0], 0.1)
    return scene

def state(backend, sim=None):
    sim = sim or rf.Simulation(column(), dt=0.005, backend=backend)
    sim.run(20)
    return sim.positions.tobytes()

def name_error(work):
    try:
        work()
    except rf.SimulationError as error:
        return str(error)
    return "none"

def in_child(work):
    here, there = multiprocessing.Pipe()
    child = multiprocessing.get_context("fork").Process(target=lambda: there.send(work()))
    child.start()
    assert here.poll(60), "the child hangs"
    found = here.recv()
    child.join(20)
    assert child.exitcode == 0
    return found
"""

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="processes are forked on Linux")


def run(script: str) -> None:
    found = subprocess.run([sys.executable, "-c", SETUP + script], capture_output=True, text=True, check=False, timeout=240)
    assert (found.returncode, found.stderr) == (0, "")


def test_a_forked_process_runs_on_the_cpu() -> None:
    run(
        """
expected = state("cpu")
assert in_child(lambda: state("cpu")) == expected
# A child of a child.
assert in_child(lambda: in_child(lambda: state("cpu"))) == expected
# A simulation, worlds and an evolution of the parent.
sim = rf.Simulation(column(), dt=0.005, backend="cpu")
assert in_child(lambda: state("cpu", sim)) == expected == state("cpu", sim)
worlds = rf.Worlds(column(), 0.005, count=4, backend="cpu")
def moved():
    worlds.run(20)
    return worlds.positions[3].tobytes()
assert in_child(moved) == expected == moved()
"""
    )


def test_auto_works_in_a_forked_process_without_a_hardware_gpu() -> None:
    run(
        """
if not any(not device.software for device in rf.devices()):
    assert in_child(lambda: state("auto")) == state("auto")
"""
    )


@pytest.mark.parametrize("use", ["state('gpu')", "rf.Simulation(column(), backend='cpu').render((64, 48))"])
def test_the_gpu_in_a_forked_process_is_an_error_that_says_what_to_do(use: str) -> None:
    run(
        f"""
sim = rf.Simulation(column(), dt=0.005, backend="gpu") if "gpu" in {use!r} else None
worlds = rf.Worlds(column(), 0.005, count=2, backend="gpu") if sim else None
{use}
works = [lambda: state("gpu"), lambda: rf.devices(), lambda: rf.Simulation(column(), backend="cpu").render((64, 48))]
works += [lambda: sim.run(1), lambda: sim.positions, lambda: repr(sim), lambda: worlds.run(1)] if sim else []
for work in works:
    found = in_child(lambda: name_error(work))
    assert "spawn" in found and "backend=\\"cpu\\"" in found, found
expected = state("cpu")
assert in_child(lambda: state("cpu")) == expected
{use}
"""
    )


def test_a_process_may_use_the_gpu_first_in_the_child() -> None:
    run("assert in_child(lambda: state('gpu')) == state('gpu')")


@pytest.mark.parametrize("backend", ["auto", "cpu"])
def test_gymnasium_s_asynchronous_vectors_step(backend: str) -> None:
    run(
        f"""
import gymnasium
import rockfall.gym

if "{backend}" == "cpu" or not any(not device.software for device in rf.devices()):
    envs = gymnasium.make_vec(
        "rockfall/Walker-v0", num_envs=2, vectorization_mode="async", vector_kwargs={{"context": "fork"}}, backend="{backend}"
    )
    envs.reset(seed=1)
    for _ in range(3):
        found = envs.step(envs.action_space.sample())
    assert found[0].shape[0] == 2
    envs.close()
"""
    )
