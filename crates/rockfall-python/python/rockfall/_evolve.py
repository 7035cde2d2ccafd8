"""Evolution of creatures of masses, springs and muscles."""

from __future__ import annotations

import os
import pathlib
import tempfile
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from rockfall import _rockfall
from rockfall._arrays import floats, time_step, whole
from rockfall._attributes import Strict, keywords
from rockfall._progress import Progress
from rockfall._scene import Scene
from rockfall.typing import BackendName, BodyName, GoalName, IntegratorName

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from rockfall._options import EvolutionOptions

_HISTORY = np.dtype(
    [
        ("number", np.int64),
        ("champion", np.float64),
        ("best", np.float64),
        ("mean", np.float64),
        ("niches", np.int64),
        ("not_finite", np.int64),
        ("exploded", np.int64),
        ("unsteady", np.int64),
        ("downhill", np.int64),
        ("failed_audits", np.int64),
    ]
)


@dataclass(frozen=True)
class Creature:
    """A creature that evolved, and what it did."""

    #: The creature on its ground, for simulations.
    scene: Scene
    #: Fitness, in the unit of the goal.
    fitness: float
    #: Horizontal distance of the centre from the end of settling to the end, in units.
    distance: float
    #: Standard deviation of the height of the centre, divided by its mean height.
    bounce: float
    #: Extent of the body along its longer horizontal side, in units.
    length: float
    #: Frequency of the muscles, in 1/s.
    frequency: float
    #: Number of masses.
    masses: int


class Evolution(Strict):
    """Creatures that evolve, generation by generation. ``rockfall evolve`` on the command line does the same.

    A creature has 4 to 20 masses, joined by springs that are muscles. Every generation is made from the best creatures of each kind
    so far, by mutation and crossover. Creatures that explode, fall over, leap once or go downhill do not count, and one that
    would become the champion is audited: it must keep 70 % of its fitness at half and at a quarter of the time step, and with starts
    that are disturbed by 0.0001 units. The same seed gives the same champion, bit for bit, on the same device.

    Parameters
    ----------
    population : int
        Creatures per generation, from 2 to 1,000,000.
    seconds : float
        Simulated time of each creature, from 1 to 1000 s.
    dt : float
        Time step, in s.
    goal : {"distance", "speed", "height", "jump", "climb"}
        What the fitness is: see docs/creatures.md for the goals and their units. "climb" needs a ground.
    body : {"lattice", "free"}
        Where masses may be.
    ground : Scene, optional
        Ground and constants: boxes, polygons and settings; by default level, with gravity 9.81.
    seed : int
        Seed of the random numbers.
    integrator : {"rk4", "symplectic-euler", "velocity-verlet"}
        How positions and velocities are advanced.
    backend : {"auto", "gpu", "cpu"}
        Where to compute.

    Raises
    ------
    ValueError, TypeError
        For a value or a type that is not allowed. The message names the argument.
    """

    def __init__(
        self,
        population: int = 10240,
        *,
        seconds: float = 10.0,
        dt: float = 0.005,
        goal: GoalName = "distance",
        body: BodyName = "lattice",
        ground: Scene | None = None,
        seed: int = 0,
        integrator: IntegratorName = "rk4",
        backend: BackendName = "auto",
    ) -> None:
        for name, value in (("goal", goal), ("body", body), ("integrator", integrator), ("backend", backend)):
            if not isinstance(value, str):
                raise TypeError(f"{name}: expected a str, got {type(value).__name__}")
        creatures = whole("population", population, least=2)
        if creatures > 1_000_000:
            raise ValueError(f"population: expected at most 1000000, got {creatures}")
        dt = time_step("dt", dt)
        floats("seconds", seconds, (), 1)
        if not 1.0 <= seconds <= 1000.0:
            raise ValueError(f"seconds: expected a number from 1 to 1000, got {seconds}")
        if seconds / dt < 19.5:
            raise ValueError(f"dt: expected at least 20 steps in {seconds:g} seconds, got {dt:g}")
        if goal == "climb" and ground is None:
            raise ValueError("ground: expected a Scene for the goal climb, because on level ground there is nothing to climb")
        if ground is not None and not isinstance(ground, Scene):
            raise TypeError(f"ground: expected a rockfall.Scene, got {type(ground).__name__}")
        if ground is not None and ground.counts.spheres > 0:
            raise ValueError(f"ground: expected only boxes, polygons and settings, got {ground.counts.spheres} spheres")
        self._backend = backend
        native = None if ground is None else ground._native
        self._native: Any = _rockfall.Evolution(
            creatures, whole("seed", seed), body, goal, float(seconds), dt, integrator, native, backend
        )

    @classmethod
    def load(cls, path: str | os.PathLike[str], *, backend: BackendName = "auto") -> Evolution:
        """Continue a saved evolution. On the same device, the results are those of a run without interruption.

        Parameters
        ----------
        path : path
            A file that :meth:`save` or ``rockfall evolve --checkpoint`` wrote.
        backend : {"auto", "gpu", "cpu"}
            Where to compute.

        Raises
        ------
        OSError
            If the file cannot be read.
        ValueError
            If it is not a saved evolution.
        """
        evolution = cls.__new__(cls)
        evolution._backend = backend
        evolution._native = _rockfall.Evolution.load(os.fspath(path), backend)
        return evolution

    def run(
        self, generations: int, *, checkpoint: str | os.PathLike[str] | None = None, progress: bool = False
    ) -> None:
        """Create generations and simulate their creatures.

        Parameters
        ----------
        generations : int
            Number of generations, in addition to those that are done.
        checkpoint : path, optional
            A file that is written after every generation, for :meth:`load`.
        progress : bool
            Whether to show a progress bar with the best and the mean fitness, by tqdm where it is installed.

        Raises
        ------
        KeyboardInterrupt
            After Ctrl-C. The generation under way is left out, and the evolution can go on.
        SimulationError
            When the device fails.
        OSError
            If the checkpoint cannot be written.
        """
        count = whole("generations", generations)
        path = None if checkpoint is None else os.fspath(checkpoint)
        with Progress(count if progress else None, "generation") as bar:
            for _ in range(count):
                done = self._native.generation()
                if path is not None:
                    self._native.save(path)
                bar.note(f"champion {done['champion']:.2f}, mean {done['mean']:.2f}, {done['niches']} kinds")
                bar.advance(1)

    def adopt(self, other: Evolution) -> int:
        """Take from another evolution the creatures that are fitter than those of their kinds, and return their number.

        Evolutions can be pickled, so those on several machines can exchange creatures. The example ``islands.py`` does it with
        Ray.

        Raises
        ------
        ValueError
            If other arguments than population, seed and backend differ.
        """
        if not isinstance(other, Evolution):
            raise TypeError(f"other: expected a rockfall.Evolution, got {type(other).__name__}")
        return int(self._native.adopt(other._native))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write everything that determines the following generations to a file. Raises OSError if that fails."""
        self._native.save(os.fspath(path))

    @property
    def champion(self) -> Creature | None:
        """The best creature that has passed an audit; None if there is none."""
        found = self._native.champion()
        return None if found is None else _creature(found)

    def gallery(self, most: int = 12) -> list[Creature]:
        """The fittest creatures of different kinds that pass an audit, up to ``most`` of them."""
        return [_creature(found) for found in self._native.gallery(whole("most", most))]

    @property
    def history(self) -> npt.NDArray[Any]:
        """One row per generation: a structured array.

        ``number`` counts from 1. ``champion`` is the fitness of the champion so far, ``best`` and ``mean`` are those of the
        generation; creatures that do not count have 0. ``niches`` is the number of kinds with a creature, and ``not_finite``,
        ``exploded``, ``unsteady``, ``downhill`` and ``failed_audits`` are numbers of creatures that do not count.
        """
        found = self._native.history()
        table = np.zeros(len(found), _HISTORY)
        for row, generation in zip(table, found, strict=True):
            for name, value in generation.items():
                row[name] = value
        return table

    @property
    def plan(self) -> dict[str, Any]:
        """The arguments of the evolution, and ``settling_steps`` and ``steps``, between which the distance counts."""
        plan: dict[str, Any] = self._native.plan()
        plan["dt"] = float(str(np.float32(plan["dt"])))
        return plan

    def __reduce__(self) -> Any:
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "evolution.json"
            self.save(path)
            return (_revive, (path.read_bytes(), self._backend))

    def __repr__(self) -> str:
        done, champion = len(self.history), self.champion
        best = "no champion" if champion is None else f"champion {champion.fitness:.3f}"
        return f"<rockfall.Evolution: {done} generations of {self.plan['population']} creatures, {best}>"


@keywords
def evolve(
    generations: int = 100,
    population: int = 10240,
    *,
    checkpoint: str | os.PathLike[str] | None = None,
    progress: bool = True,
    **options: Unpack[EvolutionOptions],
) -> Evolution:
    """Evolve creatures. ``rockfall evolve`` on the command line gives the same champion.

    Parameters
    ----------
    generations, population : int
        Number of generations, and creatures in each.
    checkpoint : path, optional
        A file that is written after every generation. If it exists, the evolution goes on from it up to ``generations`` in all,
        and ``population`` and the other arguments must not differ from it.
    progress : bool
        Whether to show a progress bar.
    **options
        The other arguments of :class:`Evolution`: seconds, dt, goal, body, ground, seed, integrator and backend.

    Returns
    -------
    Evolution
        The evolution, with its champion and its history.

    Raises
    ------
    KeyboardInterrupt
        After Ctrl-C. The generation under way is left out; with a checkpoint, the same call goes on after the one before.
    ValueError, TypeError
        As for :class:`Evolution`, and for a checkpoint of an evolution with other arguments.

    Examples
    --------
    >>> found = rf.evolve(30, 256, seed=1, backend="cpu")  # doctest: +SKIP
    >>> found.champion.scene.save("walker.txt")  # doctest: +SKIP
    """
    whole("generations", generations)
    evolution = Evolution(population, **options)
    if checkpoint is not None and os.path.exists(checkpoint):
        wanted = evolution
        evolution = Evolution.load(checkpoint, backend=options.get("backend", "auto"))
        for name, value in evolution.plan.items():
            if wanted.plan[name] != value:
                raise ValueError(f"{name}: expected {value} as in {os.fspath(checkpoint)}, got {wanted.plan[name]}")
    left = max(0, generations - len(evolution.history))
    evolution.run(left, checkpoint=checkpoint, progress=progress)
    return evolution


def _revive(saved: bytes, backend: BackendName) -> Evolution:
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "evolution.json"
        path.write_bytes(saved)
        return Evolution.load(path, backend=backend)


def _creature(found: dict[str, Any]) -> Creature:
    return Creature(**{**found, "scene": Scene._of(found["scene"])})
