"""Many small scenes side by side."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from rockfall import _rockfall
from rockfall._arrays import FloatArray, floats, time_step, whole
from rockfall._progress import Progress
from rockfall._scene import Scene
from rockfall._world_observe import ObservedWorlds
from rockfall._world_states import STATES, frozen
from rockfall.typing import BackendName, BroadPhaseName, FieldName, IntegratorName


class Worlds(ObservedWorlds):
    """Many small scenes that advance side by side, each in its own world.

    Worlds do not affect each other. Each has its own bodies, static objects and settings, and advances exactly as in a
    :class:`Simulation` of its own with the same options: the results are bitwise identical, whatever other worlds there are. On
    the CPU, worlds are divided among all cores. On the GPU, a workgroup runs a small world, or several of them, for many
    steps in one dispatch (``workgroup`` of :meth:`report`). Worlds with hard contacts and the same walls share frames, as
    long as nothing moves on a motion and there are no springs. Other worlds run one after the other.

    Parameters
    ----------
    scenes : sequence of Scene, or Scene
        A world for each scene, numbered from 0; or one scene, of which there are ``count`` worlds. They are copied.
    dt : float, optional
        Time step, in s. It can be changed later. By default it is that of the scenes (:attr:`Scene.run`), or 0.02.
    count : int, optional
        Number of worlds with the same scene.
    backend, device, integrator, broad_phase, keep_going
        As for :class:`Simulation`, the same for all worlds. With the integrator "auto", each world has that of its own scene.
    check : bool
        Whether the first steps with a time step, or after a replacement, warn (:class:`SceneWarning`) of what :meth:`Scene.check`
        finds. A warning that several worlds have is given once. Of more than 64 worlds, up to 64 are checked, evenly spaced.

    Raises
    ------
    ValueError
        For a value that is not allowed.
    TypeError
        For scenes that are not of the class Scene.
    SimulationError
        If there is no GPU for ``backend="gpu"``.

    Notes
    -----
    Arrays hold all worlds at once. W is the number of worlds, N the largest number of spheres in a world, and M the largest number
    of springs. Worlds with fewer spheres or springs have rows of zeros at their end; :attr:`mask` and :attr:`spring_mask` say
    which rows exist. Values for rows that do not exist are ignored.

    Arrays that are read are copies in order of addition, and read-only. Assign arrays to change the worlds. An array for one world,
    for example of shape (N, 3), counts for all.

    If the state of a body stops being finite, its world is stopped, with the reason in :attr:`stopped`. The others go on.

    Examples
    --------
    >>> import rockfall as rf
    >>> scene = rf.Scene()
    >>> ball = scene.add_sphere([0, 1, 0], radius=0.1)
    >>> worlds = rf.Worlds(scene, dt=0.01, count=100)
    >>> worlds.velocities = np.linspace(0, 1, 100)[:, None, None] * [1, 0, 0]
    >>> worlds.run(10)
    >>> worlds.positions.shape
    (100, 1, 3)
    """

    def __init__(
        self,
        scenes: Sequence[Scene] | Scene,
        dt: float | None = None,
        *,
        count: int | None = None,
        backend: BackendName = "auto",
        device: int | None = None,
        integrator: IntegratorName = "auto",
        broad_phase: BroadPhaseName = "auto",
        keep_going: bool = False,
        check: bool = True,
    ) -> None:
        scenes = scenes if isinstance(scenes, Scene) else _scenes("scenes", scenes)
        natives, worlds = _natives(scenes, count)
        for name, value in (("backend", backend), ("integrator", integrator), ("broad_phase", broad_phase)):
            if not isinstance(value, str):
                raise TypeError(f"{name}: expected a str, got {type(value).__name__}")
        step = _time_step(scenes, dt)
        number = None if device is None else whole("device", device)
        methods = (backend, number, integrator, broad_phase, bool(keep_going))
        native = _rockfall.Worlds(natives, worlds, methods)
        self._begin(native, step, bool(check))

    def _begin(self, native: Any, dt: float, check: bool) -> None:
        self._native = native
        self._dt = dt
        _rockfall.set_worlds_time_step(native, dt)
        self._checks, self._checked = check, None
        self._studio = None

    @classmethod
    def resume(cls, path: str | os.PathLike[str], dt: float | None = None, *, backend: BackendName | None = None) -> Worlds:
        """Continue from a checkpoint, with results that are bitwise identical to those of a run without interruption.

        Parameters
        ----------
        path : path
            A file that :meth:`save_checkpoint` wrote.
        dt : float, optional
            Time step of the following steps, in s; by default that of the worlds that were saved.
        backend : {"auto", "gpu", "cpu"}, optional
            Another backend than that of the checkpoint. Results then differ by rounding.

        Raises
        ------
        OSError
            If the file cannot be read.
        ValueError
            If it is not a usable checkpoint of worlds.
        """
        given = None if dt is None else time_step("dt", dt)
        native = _rockfall.Worlds.resume(os.fspath(path), backend)
        # The decimal number that was written as f32.
        own = float(str(np.float32(_rockfall.worlds_time_step(native))))
        worlds = cls.__new__(cls)
        worlds._begin(native, own if given is None else given, check=True)
        worlds._checked = own
        return worlds

    def save_checkpoint(self, path: str | os.PathLike[str]) -> None:
        """Write everything that determines the following steps, and the starts of all worlds, to a file for :meth:`resume`."""
        self._native.save_checkpoint(os.fspath(path))

    def copy(self) -> Worlds:
        """Other worlds in the same state, which take the same steps to the same bits."""
        build, arguments = self.__reduce__()
        copied: Worlds = build(*arguments)
        return copied

    def __copy__(self) -> Worlds:
        raise TypeError("worlds have no shallow copy: call worlds.copy(), which makes independent worlds in the same state")

    def __deepcopy__(self, memo: Any) -> Worlds:
        return self.copy()

    def __reduce__(self) -> Any:
        return (_from_bytes, (self._native.to_bytes(), self._dt, self._checks, self._checked))

    # Steps

    @property
    def dt(self) -> float:
        """Time step, in s."""
        return self._dt

    @dt.setter
    def dt(self, value: float) -> None:
        self._dt = time_step("dt", value)
        _rockfall.set_worlds_time_step(self._native, self._dt)

    def run(
        self,
        steps: int,
        *,
        rest_lengths: npt.ArrayLike | None = None,
        external_forces: npt.ArrayLike | None = None,
        every: int = 1,
        progress: bool = False,
    ) -> None:
        """Run steps in all worlds that are not stopped.

        Parameters
        ----------
        steps : int
            Number of steps.
        rest_lengths : array_like, shape (T, W, M) or (T, M), optional
            Rest lengths of the springs, in units. Row t applies from step ``t * every`` of this call on. T is
            ``steps / every``, rounded up. The last row holds until it is changed.
        external_forces : array_like, shape (T, W, N, 3) or (T, N, 3), optional
            External forces on the spheres, in mass units/s², in the same way.
        every : int
            Number of steps from one row to the next.
        progress : bool
            Whether to show a progress bar, by tqdm where it is installed.

        Raises
        ------
        ValueError
            For a wrong shape or value. No step is done then.
        SimulationError
            When the device fails. What happens in a single world is in :attr:`stopped`.
        KeyboardInterrupt
            After Ctrl-C. All worlds have done the same number of steps and can go on. The next row of controls may already
            apply.
        """
        left, every = whole("steps", steps), whole("every", every, least=1)
        rows = -(-left // every)
        lengths = forces = None
        if rest_lengths is not None:
            lengths = self._controls("rest_lengths", rest_lengths, (), rows)
        if external_forces is not None:
            forces = self._controls("external_forces", external_forces, (3,), rows)
        if left > 0:
            self._check()
        with Progress(left if progress else None) as bar:
            advance = bar.advance if progress else None
            if lengths is None and forces is None:
                self._native.run(left, self._dt, advance)
                return
            everyone = np.arange(len(self), dtype=np.int64)
            for row in range(rows):
                if lengths is not None:
                    self._native.put_rest_lengths(everyone, lengths[row].ravel())
                if forces is not None:
                    self._native.put("force", everyone, forces[row].ravel())
                self._native.run(min(every, left - row * every), self._dt, advance)

    def record(self, steps: int, every: int = 1, field: FieldName = "positions") -> FloatArray:
        """Run steps in all worlds that are not stopped, and return a state of all spheres after every ``every`` steps.

        On a GPU this is faster than calls of :meth:`run` in a loop: the device runs the next steps while states are copied.

        Parameters
        ----------
        steps : int
            Number of steps.
        every : int
            Number of steps from one sample to the next. The last step gives a sample, too.
        field : {"positions", "velocities", "orientations", "angular_momenta"}
            What is recorded, with the units and columns of the property of that name.

        Returns
        -------
        array, shape (T, W, N, 3), or (T, W, N, 4) for orientations
            T is ``steps / every``, rounded up. Rows of spheres that do not exist are 0. A stopped world keeps its last state.

        Raises
        ------
        ValueError, TypeError
            For a value or a type that is not allowed. No step is done then.
        SimulationError
            When the device fails. What happens in a single world is in :attr:`stopped`.
        KeyboardInterrupt
            After Ctrl-C. All worlds have done the same number of steps and can go on.
        """
        if field not in STATES:
            raise ValueError(f"field: expected one of {', '.join(STATES)}, got {field!r}")
        native, _ = STATES[field]
        count, stride = whole("steps", steps), whole("every", every, least=1)
        if count > 0:
            self._check()
        return frozen(self._native.record(count, self._dt, stride, native))

    def reset(self, worlds: npt.ArrayLike | None = None) -> None:
        """Return worlds to the state in which they were created or replaced, at time 0. Stopped worlds advance again.

        Parameters
        ----------
        worlds : array_like of int, shape (K,) or (), or of bool, shape (W,), optional
            The worlds, by number or by a mask; all by default.

        Raises
        ------
        LookupError
            For a world that does not exist. Nothing is changed then.
        """
        self._native.reset(self._numbers(worlds))

    def replace(self, worlds: npt.ArrayLike, scenes: Sequence[Scene] | Scene) -> None:
        """Replace worlds by new ones with these scenes, at time 0.

        Parameters
        ----------
        worlds : array_like of int, shape (K,) or (), or of bool, shape (W,)
            The worlds, by number or by a mask.
        scenes : sequence of Scene, or Scene
            A scene for each world, or one for all of them.

        Raises
        ------
        LookupError
            For a world that does not exist. Nothing is changed then.
        ValueError
            If there are not as many scenes as worlds. Nothing is changed then.
        """
        numbers = self._numbers(worlds)
        found = _scenes("scenes", scenes)
        if isinstance(scenes, Scene):
            found = found * len(numbers)
        if len(found) != len(numbers):
            raise ValueError(f"scenes: expected {len(numbers)} scenes, one per world, got {len(found)}")
        self._checked = None
        self._native.replace(numbers, [scene._native for scene in found])

    def replace_all(self, scenes: Sequence[Scene] | Scene, *, count: int | None = None) -> None:
        """Replace all worlds by a world for each of these scenes, at time 0.

        This is faster than new worlds, because the device stays open and its kernels stay compiled. Results are the same.
        Arguments are those of :class:`Worlds`. The number of worlds may change.

        Raises
        ------
        ValueError, TypeError
            As for :class:`Worlds`. The worlds are unchanged then.
        """
        self._native.replace_all(*_natives(scenes, count))
        self._checked = None

    # Sleep

    @property
    def sleep(self) -> dict[str, Any]:
        """When worlds sleep, and whether they stand still then: the arguments of :meth:`set_sleep`."""
        speed, steps, skip = self._native.sleep()
        return {"speed": speed, "steps": steps, "skip": skip}

    def set_sleep(self, speed: float = 0.01, steps: int = 100, *, skip: bool = False) -> None:
        """Set when worlds sleep. Steps without motion are counted again from 0.

        A world sleeps when no centre and no surface of a sphere was faster than ``speed`` at the end of each of the last ``steps``
        steps. A world with muscles or walls that follow a motion never sleeps, nor one on a GPU without ``workgroup``. Setting states, rest lengths or forces,
        resets and replacements wake it up.

        Parameters
        ----------
        speed : float
            Greatest speed of a sphere that does not move, in units/s.
        steps : int
            Number of steps, at least 1.
        skip : bool
            Whether sleeping worlds stand still until they wake up. By default they are only reported.

        Raises
        ------
        ValueError, TypeError
            For a value or a type that is not allowed. Nothing is changed then.
        """
        limit = float(floats("speed", speed, (), 1, not_negative=True)[0])
        number = whole("steps", steps, least=1)
        if number >= 2**32:
            raise ValueError(f"steps: expected less than 2**32, got {number}")
        self._native.set_sleep(limit, number, bool(skip))

    def __repr__(self) -> str:
        return f"<rockfall.Worlds: {len(self)} worlds, {int(self.sphere_counts.sum())} spheres, {self.backend.kind}>"


def _from_bytes(data: bytes, dt: float, checks: bool, checked: float | None) -> Worlds:
    worlds = Worlds.__new__(Worlds)
    worlds._begin(_rockfall.Worlds.from_bytes(data), dt, checks)
    worlds._checked = checked
    return worlds


def _natives(scenes: Sequence[Scene] | Scene, count: int | None) -> tuple[list[Any], int | None]:
    """The native scenes, and the number of worlds with a single one."""
    several = isinstance(scenes, Scene)
    if several and count is None:
        raise TypeError("count: expected the number of worlds with this scene, got None")
    if not several and count is not None:
        raise TypeError("count: expected None for several scenes; it is the number of worlds with one scene")
    natives = [scene._native for scene in _scenes("scenes", scenes)]
    if not natives:
        raise ValueError("scenes: expected at least one Scene")
    return natives, None if count is None else whole("count", count)


def _scenes(name: str, value: Any) -> list[Scene]:
    if isinstance(value, Scene):
        return [value]
    try:
        scenes = list(value)
    except TypeError:
        raise TypeError(f"{name}: expected a Scene or a sequence of them, got {type(value).__name__}") from None
    for place, scene in enumerate(scenes):
        if not isinstance(scene, Scene):
            raise TypeError(f"{name}: expected a Scene at place {place}, got {type(scene).__name__}")
    return scenes


def _time_step(scenes: Sequence[Scene] | Scene, given: float | None) -> float:
    """The time step that is given, or that of all scenes."""
    found = {scene._time_step(given) for scene in _scenes("scenes", scenes)}
    if len(found) > 1:
        raise ValueError(f"dt: expected a time step, because the scenes have different ones: {sorted(found)}")
    return found.pop() if found else time_step("dt", 0.02 if given is None else given)
