"""Checks simulations that processes share over MPI. `scripts/test-python-mpi` runs it with several numbers of processes:

mpirun -n 3 python -m mpi4py check_mpi.py FOLDER

FOLDER has the scenes that `scripts/mpi-scenes` writes.
"""

from __future__ import annotations

import signal
import sys
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
from mpi4py import MPI

import rockfall as rf

COMM = MPI.COMM_WORLD
FIELDS = ("positions", "velocities", "orientations", "angular_momenta", "centres")


def same(one: rf.Simulation, other: rf.Simulation) -> None:
    """Both have the same bits in all that can be read."""
    for field in FIELDS:
        a, b = getattr(one, field), getattr(other, field)
        assert a.tobytes() == b.tobytes(), f"{COMM.size} processes: {field} differ in {np.count_nonzero(a != b)} numbers"
    assert one.energy == other.energy
    assert one.contacts.tobytes() == other.contacts.tobytes()
    assert one.diagnostics.tobytes() == other.diagnostics.tobytes()
    assert (one.steps, one.time) == (other.steps, other.time)
    a, b = one.report, other.report
    assert (a.contacts, a.max_overlap) == (b.contacts, b.max_overlap), f"{a} {b}"


def raised(kind: type[BaseException], text: str, call: Callable[[], object]) -> None:
    """The call raises an error of this kind whose message contains a text, on every process."""
    try:
        call()
    except kind as error:
        assert text in str(error), f"{error!r} does not contain {text!r}"
    else:
        raise AssertionError(f"expected a {kind.__name__} with {text!r}")


def both(scene: rf.Scene) -> tuple[rf.Simulation, rf.Simulation]:
    alone = rf.Simulation(scene, backend="cpu", check=False)
    return alone, rf.Simulation(scene, backend="cpu", check=False, comm=COMM)


def check_steps(scene: rf.Scene) -> int:
    """Runs steps in several ways. Returns the number of contacts at the end."""
    alone, shared = both(scene)
    same(alone, shared)
    for steps in (0, 1, 400):
        reports = [simulation.run(steps) for simulation in (alone, shared)]
        assert [report.contacts for report in reports] == [reports[0].contacts] * 2
        assert reports[0].max_overlap == reports[1].max_overlap
        same(alone, shared)
    for _ in range(5):
        alone.step()
        shared.step()
    same(alone, shared)
    for simulation in (alone, shared):
        simulation.dt *= 0.5
        simulation.run(20)
        simulation.dt *= 1.5
        simulation.run(70)
    same(alone, shared)
    return int(alone.contacts.size)


def check_files(scene: rf.Scene, folder: Path) -> None:
    alone, shared = both(scene)
    for name, simulation in ((f"alone-{COMM.rank}", alone), ("shared", shared)):
        with simulation.record(folder / f"{name}.npz", every=40) as recording:
            simulation.run(100)
            recording.frame()
    COMM.barrier()
    assert (folder / f"alone-{COMM.rank}.npz").read_bytes() == (folder / "shared.npz").read_bytes()
    shared.save_checkpoint(folder / "shared.ckpt")
    COMM.barrier()
    again = rf.Simulation.resume(folder / "shared.ckpt", comm=COMM)
    before = rf.Simulation.resume(folder / "shared.ckpt")
    for simulation in (alone, shared, again, before):
        simulation.run(50)
    for simulation in (shared, again, before):
        same(alone, simulation)
    kind = OSError if COMM.rank == 0 else rf.SimulationError
    raised(kind, "", lambda: shared.save_checkpoint(folder / "missing" / "x.ckpt"))
    raised(kind, "", lambda: shared.record(folder / "missing" / "x.npz"))
    same(alone, shared)


def check_refused(scene: rf.Scene) -> None:
    rods = rf.Scene()
    rods.add_spheres([[0, 0, 0], [1, 0, 0]], radius=0.1, mass=1.0)
    rods.add_rods(0, 1, radius=0.05)
    raised(ValueError, "a scene with rods", lambda: rf.Simulation(rods, backend="cpu", comm=COMM))
    raised(TypeError, "expected a communicator", lambda: rf.Simulation(scene, comm=3))  # type: ignore[arg-type]
    raised(rf.SimulationError, "null", lambda: rf.Simulation(scene, comm=MPI.COMM_NULL))
    alone, shared = both(scene)

    def assign(field: str) -> None:
        setattr(shared, field, getattr(alone, field) + 1)

    for call in (
        lambda: assign("positions"),
        lambda: assign("centres"),
        lambda: shared.set(0, velocity=[1, 0, 0]),
        lambda: shared.apply_impulse(0, [1, 0, 0]),
        lambda: shared.add_spheres([[0, 9, 0]], radius=0.1, mass=1.0),
        lambda: shared.remove("sphere", 0),
        lambda: setattr(shared.settings, "gravity", 1.0),
        lambda: shared.handle_collisions(),
        lambda: shared.profile(1),
        lambda: shared.copy(),
        lambda: shared.restore("none.ckpt"),
    ):
        raised((ValueError, OSError), "", call)  # type: ignore[arg-type]
    raised(ValueError, "processes share", lambda: assign("velocities"))
    assert not shared.positions.flags.writeable
    same(alone, shared)


def check_stops(scene: rf.Scene) -> None:
    """An error or a signal on one process stops the run on all."""
    alone, shared = both(scene)
    last = COMM.size - 1
    signal.signal(signal.SIGALRM, lambda *_: signal.raise_signal(signal.SIGINT))
    if COMM.rank == last:
        signal.setitimer(signal.ITIMER_REAL, 0.3)
    raised(KeyboardInterrupt, "", lambda: shared.run(10**9))
    steps = shared.steps
    assert COMM.allgather(steps) == [steps] * COMM.size and 0 < steps < 10**9
    alone.run(steps)
    same(alone, shared)

    def fail(*_: object) -> None:
        raise RuntimeError("of one process")

    if COMM.rank == last:
        signal.signal(signal.SIGALRM, fail)
        signal.setitimer(signal.ITIMER_REAL, 0.3)
    kind, text = (RuntimeError, "of one process") if COMM.rank == last else (rf.SimulationError, "another process")
    raised(kind, text, lambda: shared.run(10**9))
    alone.run(shared.steps - alone.steps)
    same(alone, shared)


def check_different_calls(scene: rf.Scene) -> None:
    _, shared = both(scene)
    shared.step()
    if COMM.size > 1:
        first = COMM.rank == 0
        raised(rf.SimulationError, "different calls", lambda: shared.positions if first else shared.run(3))
        raised(rf.SimulationError, "cannot go on", lambda: shared.run(1))
    shared = rf.Simulation(scene, backend="cpu", check=False, comm=COMM)
    if COMM.size > 1:
        raised(rf.SimulationError, "different calls", lambda: shared.run(3 + COMM.rank))


def main() -> None:
    warnings.simplefilter("ignore", rf.SceneWarning)
    scenes = {name: rf.Scene.load(Path(sys.argv[1]) / f"{name}.txt") for name in ("column", "euler", "gas", "shaken")}
    for name, scene in scenes.items():
        contacts = check_steps(scene)
        assert contacts > 0 or name == "gas", name
    folder = Path(COMM.bcast(tempfile.mkdtemp(dir=sys.argv[1]) if COMM.rank == 0 else None))
    check_files(scenes["column"], folder)
    check_refused(scenes["column"])
    check_stops(scenes["column"])
    check_different_calls(scenes["column"])
    # A part of the processes, each with a simulation of its own.
    single = rf.Simulation(scenes["gas"], backend="cpu", comm=MPI.COMM_SELF)
    single.run(10 + COMM.rank)
    if COMM.rank == 0:
        print(f"{COMM.size} processes have the bits of one")


main()
