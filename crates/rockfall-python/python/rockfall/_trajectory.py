"""Trajectories: files with the states over time."""

from __future__ import annotations

import os
import weakref
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from rockfall import _rockfall
from rockfall._arrays import FloatArray, IntArray, whole
from rockfall._attributes import Strict
from rockfall._look import look, warn_of_letters
from rockfall._picture import Picture
from rockfall._scene import Scene
from rockfall._tables import needed
from rockfall._team import on_first

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from rockfall._options import PictureOptions
    from rockfall._simulation import Simulation

_ARRAYS = ("positions", "velocities", "orientations", "angular_momenta")
#: Names of the columns of these arrays in tables.
_COLUMNS = (("x", "y", "z"), ("vx", "vy", "vz"), ("qw", "qx", "qy", "qz"), ("lx", "ly", "lz"))


class Recording(Strict):
    """A trajectory that is being written; :meth:`Simulation.record` begins one. A context manager.

    The file appears under its name when the recording is finished: by :meth:`finish`, at the end of a ``with`` block, when nothing
    refers to the recording and its simulation any more, or at the end of the program. A forked process writes nothing to it. Of
    processes that share the simulation, the first writes, and all call :meth:`frame` and :meth:`finish`; if it fails there, the others raise
    SimulationError.
    """

    _writer: _rockfall.TrajectoryWriter | None = None

    def __init__(self, simulation: Simulation, path: str | os.PathLike[str], every: int) -> None:
        self._every = whole("every", every, least=1)
        self._path = os.fspath(path)
        self._simulation: Simulation | None = simulation
        on_first(simulation._native, self._open)
        self._start = simulation.steps
        self._frames = 0
        self.frame()
        if self._writer is not None:
            self._left = weakref.finalize(self, self._writer.finish, simulation._native)

    def _open(self) -> None:
        self._writer = _rockfall.TrajectoryWriter(self._path)

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
        native, writer = self._simulation._native, self._writer
        native.gather()
        on_first(native, lambda: writer.frame(native) if writer is not None else None)
        self._frames += 1

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
            native, writer = simulation._native, self._writer
            if writer is not None:
                self._left.detach()
            on_first(native, lambda: writer.finish(native) if writer is not None else None)

    def __enter__(self) -> Recording:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.finish()


    def __repr__(self) -> str:
        state = "" if self._simulation is not None else ", finished"
        return f"<rockfall.Recording to {self._path!r}: {self._frames} frames{state}>"


@dataclass(frozen=True, eq=False, repr=False)
class Frame:
    """One frame of a trajectory: arrays of its N spheres in order of addition."""

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
    #: Numbers of the spheres in the file, of shape (N,). A sphere has the same number in all frames.
    ids: IntArray

    def __repr__(self) -> str:
        return f"<rockfall.Frame: step {self.step}, {self.time:g} s, {len(self.positions)} spheres>"


class Trajectory(Strict, Sequence[Frame]):
    """A trajectory file, ``.npz`` or ``.pvd``, as a sequence of frames that are read when they are used.

    ``trajectory[-1]`` is a frame, and ``trajectory[::10]`` a trajectory of every tenth one. :attr:`positions` and the other arrays
    hold all frames at once, and ``trajectory["y"]`` one of the columns of :meth:`to_pandas`, of shape (T, N). :meth:`render` draws a
    frame, and :func:`rockfall.film` films a trajectory.

    Where spheres come and go (:attr:`is_constant` is false), frames have different numbers of spheres, and there are no arrays of all
    frames. ``trajectory[k].positions`` are the positions in a frame, ``trajectory[k].ids`` tell which spheres these are, and
    :meth:`to_pandas` has all of them.

    Raises
    ------
    OSError
        If the file cannot be read, is damaged, or is not a trajectory.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self._path = os.fspath(path)
        self._native = _rockfall.TrajectoryReader(self._path)
        self._all: list[tuple[int, float]] = self._native.moments()
        self._places: Sequence[int] = range(len(self._all))

    @property
    def scene(self) -> Scene:
        """The objects of the trajectory. The states of the spheres are those of some frame.

        Where spheres come and go, the spheres are those of all frames, and the other objects those at the end.
        """
        return Scene._of(self._native.scene())

    @property
    def is_constant(self) -> bool:
        """Whether the spheres are the same in all frames."""
        return bool(self._native.is_constant())

    @property
    def radii(self) -> FloatArray:
        """Radii of all spheres, in units; ``trajectory.radii[trajectory[k].ids]`` are those in a frame."""
        radii: FloatArray = self._native.radii()
        return radii

    @property
    def steps(self) -> list[int]:
        """Number of steps at each frame."""
        return [self._all[place][0] for place in self._places]

    @property
    def times(self) -> list[float]:
        """Simulated time of each frame, in s."""
        return [self._all[place][1] for place in self._places]

    def _one_number(self, what: str) -> None:
        """Refuses an array of all frames where their numbers of spheres differ."""
        if not self.is_constant:
            raise ValueError(
                f"{what}: spheres come and go in {self._path}, so there is no array of all frames; use the arrays of the frames, "
                "trajectory[k].positions with trajectory[k].ids, or to_pandas()"
            )

    def _floats(self) -> list[tuple[FloatArray, ...]]:
        """The arrays of each frame, in the order of ``_ARRAYS``."""
        return [self._native.frame(place)[:4] for place in self._places]

    def _stack(self, field: int, columns: int) -> FloatArray:
        self._one_number(_ARRAYS[field])
        frames = [arrays[field] for arrays in self._floats()]
        return np.stack(frames) if frames else np.zeros((0, self.scene.counts.spheres, columns), np.float32)

    @property
    def positions(self) -> FloatArray:
        """Centres in all frames, of shape (T, N, 3), in units. Reads the file."""
        return self._stack(0, 3)

    @property
    def velocities(self) -> FloatArray:
        """Velocities in all frames, of shape (T, N, 3), in units/s. Reads the file."""
        return self._stack(1, 3)

    @property
    def orientations(self) -> FloatArray:
        """Unit quaternions w, x, y, z in all frames, of shape (T, N, 4). Reads the file."""
        return self._stack(2, 4)

    @property
    def angular_momenta(self) -> FloatArray:
        """Angular momenta in all frames, of shape (T, N, 3), in mass units²/s. Reads the file."""
        return self._stack(3, 3)

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame`` with a row for each sphere in each frame. Needs pandas.

        The columns are ``step``, ``time``, ``sphere`` (one of :attr:`Frame.ids`) and, as in the CSV files of ``rockfall run``, ``x`` to
        ``lz``.
        """
        pandas = needed("pandas", "Trajectory.to_pandas")
        frames = [self._native.frame(place) for place in self._places]
        counts = [len(frame[-1]) for frame in frames]
        columns: dict[str, Any] = {
            "step": np.repeat(np.array(self.steps, np.int64), counts),
            "time": np.repeat(np.array(self.times, np.float64), counts),
            "sphere": np.concatenate([np.zeros(0, np.int64), *(frame[-1] for frame in frames)]),
        }
        for field, names in enumerate(_COLUMNS):
            rows = np.concatenate([np.zeros((0, len(names)), np.float32), *(frame[field] for frame in frames)])
            for place, name in enumerate(names):
                columns[name] = rows[:, place]
        return pandas.DataFrame(columns)

    def to_xarray(self) -> Any:
        """An ``xarray.Dataset`` with the arrays over ``time``, ``sphere`` and ``axis`` or ``component``. Needs xarray."""
        xarray = needed("xarray", "Trajectory.to_xarray")
        self._one_number("to_xarray")
        last = {"orientations": "component"}
        arrays = {name: (("time", "sphere", last.get(name, "axis")), array) for name, array in self._arrays().items()}
        places = {"time": self.times, "step": ("time", self.steps), "axis": list("xyz"), "component": list("wxyz")}
        return xarray.Dataset(arrays, coords=places)

    def _column(self, name: str) -> FloatArray:
        """A column of the tables in all frames."""
        for field, names in enumerate(_COLUMNS):
            if name in names:
                column: FloatArray = self._stack(field, len(names))[:, :, names.index(name)]
                return column
        known = [name for names in _COLUMNS for name in names]
        raise KeyError(f"{name}: expected one of {', '.join(known)}")

    def render(
        self,
        size: tuple[int, int] = (1280, 720),
        *,
        frame: int = -1,
        **options: Unpack[PictureOptions],
    ) -> Picture:
        """Draw a frame. The picture shows itself in a notebook.

        Parameters
        ----------
        size : (int, int)
            Width and height, in pixels.
        frame : int
            Number of the frame; by default the last one.
        **options
            As for :meth:`Worlds.render`. :func:`rockfall.film` also has trails and plots.

        Raises
        ------
        IndexError
            For a frame that does not exist.
        ValueError, LookupError, SimulationError
            As for :meth:`Simulation.render`.
        """
        shown = look(size, **options)
        shot = Shown(self)
        shot.show(self._index(frame))
        warn_of_letters(shot.native, shown)
        return Picture(_rockfall.Studio().take(shot.native, shown, True))

    def _index(self, index: int) -> int:
        """The place of a frame, counted from the first one."""
        place = index.__index__()
        place += len(self) if place < 0 else 0
        if not 0 <= place < len(self):
            raise IndexError(f"frame {index} does not exist: the trajectory has {len(self)} frames")
        return place

    def _arrays(self) -> dict[str, FloatArray]:
        frames = self._floats()
        if not frames:
            return {name: self._stack(0, len(names)) for name, names in zip(_ARRAYS, _COLUMNS, strict=True)}
        return {name: np.stack([frame[field] for frame in frames]) for field, name in enumerate(_ARRAYS)}

    def __len__(self) -> int:
        return len(self._places)

    @overload
    def __getitem__(self, index: int) -> Frame: ...

    @overload
    def __getitem__(self, index: slice) -> Trajectory: ...

    @overload
    def __getitem__(self, index: str) -> FloatArray: ...

    def __getitem__(self, index: int | slice | str) -> Frame | Trajectory | FloatArray:
        if isinstance(index, str):
            return self._column(index)
        if isinstance(index, slice):
            part = Trajectory.__new__(Trajectory)
            part._path, part._native, part._all, part._places = self._path, self._native, self._all, self._places[index]
            return part
        number = self._places[self._index(index)]
        positions, velocities, orientations, angular_momenta, ids = self._native.frame(number)
        return Frame(*self._all[number], positions, velocities, orientations, angular_momenta, ids)

    def __iter__(self) -> Iterator[Frame]:
        return (self[index] for index in range(len(self)))

    def __repr__(self) -> str:
        times = self.times
        ends = f" from {times[0]:g} to {times[-1]:g} s" if times else ""
        return f"<rockfall.Trajectory {self._path!r}: {len(self)} frames{ends}>"


class Shown:
    """A simulation that takes the states of a trajectory, to draw them."""

    def __init__(self, trajectory: Trajectory) -> None:
        from rockfall._simulation import Simulation

        if len(trajectory) == 0:
            raise ValueError("trajectory: expected at least one frame")
        self._trajectory = trajectory
        steps, times = trajectory.steps, trajectory.times
        #: Mean time between two frames, in s.
        self.interval = (times[-1] - times[0]) / (len(times) - 1) if len(times) > 1 else 0.0
        passed = steps[-1] - steps[0]
        # Forces of collisions depend on the time step.
        dt = (times[-1] - times[0]) / passed if passed > 0 and times[-1] > times[0] else None
        self.native = Simulation(trajectory.scene, dt, backend="cpu", check=False)._native

    def show(self, frame: int, blend: float = 0.0) -> None:
        """Shows the state at a frame, or between it and the next one."""
        places = self._trajectory._places
        self._trajectory._native.show(self.native, places[frame], places[min(frame + 1, len(places) - 1)], blend)

    def show_interval(self, number: int) -> None:
        """Shows the state after a number of mean intervals."""
        times = self._trajectory.times
        time = times[0] + number * self.interval
        frame = min(max(int(np.searchsorted(times, time + 1e-6 * self.interval, side="right")) - 1, 0), len(times) - 1)
        after = times[min(frame + 1, len(times) - 1)]
        blend = (time - times[frame]) / (after - times[frame]) if after > times[frame] else 0.0
        self.show(frame, float(np.clip(blend, 0.0, 1.0)) if blend > 1e-6 else 0.0)
