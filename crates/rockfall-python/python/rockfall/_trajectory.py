"""Trajectories: files with the states over time."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from types import TracebackType
from typing import TYPE_CHECKING

from rockfall import _rockfall
from rockfall._arrays import FloatArray, whole
from rockfall._scene import Scene

if TYPE_CHECKING:
    from rockfall._simulation import Simulation


class Recording:
    """A trajectory that is being written; :meth:`Simulation.record` begins one. A context manager.

    The file appears under its name when the recording is finished.
    """

    def __init__(self, simulation: Simulation, path: str | os.PathLike[str], every: int) -> None:
        self._every = whole("every", every, least=1)
        self._writer = _rockfall.TrajectoryWriter(os.fspath(path))
        self._simulation: Simulation | None = simulation
        self._start = simulation.steps
        self.frame()

    def frame(self) -> None:
        """Write the current state as a further frame.

        Raises
        ------
        ValueError
            If the recording is finished.
        OSError
            If the file cannot be written.
        """
        if self._simulation is None:
            raise ValueError("the recording is finished")
        self._simulation._commit()
        self._writer.frame(self._simulation._native)

    def _steps_until_frame(self, steps: int) -> int:
        return self._every - (steps - self._start) % self._every

    def _after(self, steps: int) -> None:
        if (steps - self._start) % self._every == 0:
            self.frame()

    def finish(self) -> None:
        """Complete the file. Nothing happens if it is complete already."""
        simulation, self._simulation = self._simulation, None
        if simulation is not None:
            simulation._recordings.remove(self)
            self._writer.finish(simulation._native)

    def __enter__(self) -> Recording:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.finish()


@dataclass(frozen=True)
class Frame:
    """One frame of a trajectory: arrays in order of addition."""

    #: Number of steps done.
    step: int
    #: Simulated time, in s.
    time: float
    #: Centres of shape (N, 3), in units.
    positions: FloatArray
    #: Velocities of shape (N, 3), in units/s.
    velocities: FloatArray
    #: Unit quaternions w, x, y, z of shape (N, 4).
    orientations: FloatArray
    #: Angular momenta of shape (N, 3), in mass units²/s.
    angular_momenta: FloatArray


class Trajectory:
    """A trajectory file, ``.npz`` or ``.pvd``, as a sequence of frames that are read when they are used.

    Raises
    ------
    OSError
        If the file cannot be read, is damaged, or is not a trajectory.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self._native = _rockfall.TrajectoryReader(os.fspath(path))
        self._moments: list[tuple[int, float]] = self._native.moments()

    @property
    def scene(self) -> Scene:
        """The objects of the trajectory. The states of the spheres are those of some frame."""
        return Scene._of(self._native.scene())

    @property
    def steps(self) -> list[int]:
        """Number of steps at each frame."""
        return [step for step, _ in self._moments]

    @property
    def times(self) -> list[float]:
        """Simulated time of each frame, in s."""
        return [time for _, time in self._moments]

    def __len__(self) -> int:
        return len(self._moments)

    def __getitem__(self, index: int) -> Frame:
        place = index.__index__()
        place += len(self) if place < 0 else 0
        if not 0 <= place < len(self):
            raise IndexError(f"frame {index} does not exist: the trajectory has {len(self)} frames")
        return Frame(*self._moments[place], *self._native.frame(place))

    def __iter__(self) -> Iterator[Frame]:
        return (self[index] for index in range(len(self)))
