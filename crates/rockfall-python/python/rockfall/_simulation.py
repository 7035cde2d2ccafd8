"""Simulations."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import numpy.typing as npt

from rockfall import _rockfall
from rockfall._arrays import FloatArray, IntArray, floats, integers, quaternions, time_step, whole
from rockfall._objects import Objects
from rockfall._picture import Picture
from rockfall._progress import Progress
from rockfall._reports import (
    BODY_KINDS,
    CONTACT,
    DIAGNOSTICS,
    RAY_HIT,
    Backend,
    Energy,
    Overlap,
    Profile,
    Report,
    StageTime,
    State,
)
from rockfall._scene import Scene
from rockfall._settings import Settings
from rockfall._trajectory import Recording

#: Columns of the fields of spheres that can be set.
_FIELDS = {"position": 3, "velocity": 3, "orientation": 4, "angular_momentum": 3, "force": 3}


class Simulation(Objects):
    """A scene that advances in time.

    Parameters
    ----------
    scene : Scene
        The scene, of which the simulation takes a copy.
    dt : float
        Time step, in s. It can be changed later.
    backend : {"auto", "gpu", "cpu"}
        "auto" uses a hardware GPU where there is one, otherwise the CPU.
    integrator : {"rk4", "symplectic-euler"}
        How positions and velocities are advanced.
    broad_phase : {"auto", "brute-force", "sort-and-skip", "grid"}
        How pairs that may touch are found. Results do not depend on it.
    keep_going : bool
        Whether to continue when the state of a body stops being finite. The body is then stopped and counted in
        :attr:`report`.

    Raises
    ------
    ValueError
        For a value that is not allowed.
    SimulationError
        If there is no GPU for ``backend="gpu"``, or the scene is too large.

    Notes
    -----
    Arrays such as :attr:`positions` are copies in order of addition. They belong to the state in which they were read:

    - Writing to one changes the simulation. The change takes effect before the next step, edit or read.
    - With the next step or edit it becomes a read-only snapshot, which keeps its values. Read the attribute again for the new
      state.

    So ``sim.velocities[:] = 0`` stops all bodies, and ``moved = sim.positions - before`` is what it seems to be. Call
    ``.copy()`` for an array to compute in.

    Several threads may use a simulation. They wait for each other, without the GIL.
    """

    def __init__(
        self,
        scene: Scene,
        dt: float = 0.02,
        *,
        backend: str = "auto",
        integrator: str = "rk4",
        broad_phase: str = "auto",
        keep_going: bool = False,
    ) -> None:
        if not isinstance(scene, Scene):
            raise TypeError(f"scene: expected a rockfall.Scene, got {type(scene).__name__}")
        for name, value in (("backend", backend), ("integrator", integrator), ("broad_phase", broad_phase)):
            if not isinstance(value, str):
                raise TypeError(f"{name}: expected a str, got {type(value).__name__}")
        dt = time_step("dt", dt)
        self._begin(_rockfall.Simulation(scene._native, backend, integrator, broad_phase, bool(keep_going)), dt)

    def _begin(self, native: Any, dt: float) -> None:
        self._native: Any = native
        self._dt = dt
        #: Arrays that were handed out and may be written to, by field.
        self._live: dict[str, FloatArray] = {}
        self._recordings: list[Recording] = []
        self._studio: Any = None

    @classmethod
    def resume(cls, path: str | os.PathLike[str], *, backend: str | None = None) -> Simulation:
        """Continue from a checkpoint, with results that are bitwise identical to those of a run that never stopped.

        Objects are numbered from 0 again.

        Parameters
        ----------
        path : path
            A file that :meth:`save_checkpoint` or ``rockfall run --checkpoint`` wrote.
        backend : {"auto", "gpu", "cpu"}, optional
            Another backend than that of the checkpoint. Results then differ by rounding.

        Raises
        ------
        OSError
            If the file cannot be read.
        ValueError
            If it is not a usable checkpoint.
        """
        simulation = cls.__new__(cls)
        native = _rockfall.Simulation.resume(os.fspath(path), backend)
        # The decimal number that was written as f32.
        simulation._begin(native, float(str(np.float32(native.time_step()))))
        return simulation

    # Steps

    @property
    def dt(self) -> float:
        """Time step, in s."""
        return self._dt

    @dt.setter
    def dt(self, value: float) -> None:
        self._dt = time_step("dt", value)

    def run(self, steps: int, *, progress: bool = False) -> Report:
        """Run steps.

        Parameters
        ----------
        steps : int
            Number of steps.
        progress : bool
            Whether to show a progress bar, by tqdm where it is installed.

        Returns
        -------
        Report
            Counts and times of all steps so far.

        Raises
        ------
        SimulationError
            When the state of a body stops being finite, or the device fails. The steps before are done.
        KeyboardInterrupt
            After Ctrl-C. The simulation is between two steps and can go on.

        Notes
        -----
        Other threads of Python run meanwhile.
        """
        left = whole("steps", steps)
        self._commit()
        if not progress and not self._recordings:
            self._native.run(left, self._dt, None)
            return self.report
        with Progress(left if progress else None) as bar:
            while left > 0:
                count = left
                if self._recordings:
                    done = self.steps
                    count = min(left, *(recording._steps_until_frame(done) for recording in self._recordings))
                self._native.run(count, self._dt, bar.advance if progress else None)
                left -= count
                if self._recordings:
                    done = self.steps
                    for recording in list(self._recordings):
                        recording._after(done)
        return self.report

    def step(self) -> None:
        """Run one step. Raises as :meth:`run`."""
        if self._live or self._recordings:
            self.run(1)
        else:
            self._native.run(1, self._dt, None)

    def update_aabbs(self) -> None:
        """Run phase 1 of a step alone: compute the AABBs of all objects."""
        self._phase("update_aabbs")

    def broad_phase(self) -> None:
        """Run phase 2 of a step alone: build the pair lists."""
        self._phase("broad_phase")

    def handle_collisions(self) -> None:
        """Run phase 3 of a step alone: handle collisions, whether or not they are switched on."""
        self._phase("handle_collisions")

    def update_positions(self) -> None:
        """Run phase 4 of a step alone: forces, integration and constraints. Counts as a step."""
        self._phase("update_positions")

    def _phase(self, phase: str) -> None:
        self._commit()
        self._native.phase(phase, self._dt)

    def profile(self, steps: int) -> Profile:
        """Run steps and measure the time of every stage. It takes longer than :meth:`run`."""
        self._commit()
        found = self._native.profile(whole("steps", steps, least=1), self._dt)
        found["stages"] = [StageTime(*stage) for stage in found["stages"]]
        return Profile(**found)

    @property
    def steps(self) -> int:
        """Number of steps done."""
        return self.report.steps

    @property
    def time(self) -> float:
        """Time simulated, in s."""
        return self.report.time

    @property
    def report(self) -> Report:
        """Counts and times of all steps so far."""
        return Report(**self._native.report())

    @property
    def backend(self) -> Backend:
        """The backend that runs the simulation, and why it was chosen."""
        return Backend(**self._native.backend())

    @property
    def integrator(self) -> str:
        """The integrator: "rk4" or "symplectic-euler"."""
        name: str = self._native.methods()[0]
        return name

    @property
    def broad_phase_method(self) -> str:
        """The method that finds pairs: the requested one, or the one chosen for the number of objects."""
        name: str = self._native.methods()[1]
        return name

    @property
    def device_memory(self) -> int:
        """Memory on the GPU, in bytes; 0 on the CPU backend."""
        return int(self._native.device_memory())

    # State

    def _field(self, field: str) -> FloatArray:
        array = self._live.get(field)
        if array is None:
            array = self._native.get(field)
            self._live[field] = array
        return array

    def _set_field(self, field: str, value: Any) -> None:
        array = self._field(field)
        if value is not array:
            columns = _FIELDS[field]
            array[:] = quaternions(field, value, len(array)) if columns == 4 else floats(field, value, (3,), len(array))
        self._commit()

    def _commit(self) -> None:
        """Applies what was written to arrays, and makes them snapshots."""
        if not self._live:
            return
        live, self._live = self._live, {}
        for array in live.values():
            array.flags.writeable = False
        # All are checked before the first is applied.
        for field, array in live.items():
            quaternions(field, array) if field == "orientation" else floats(field, array, (3,))
        for field, array in live.items():
            self._native.put(field, array)

    def _edited(self) -> None:
        self._commit()

    def _constant(self, field: str) -> FloatArray:
        array: FloatArray = self._native.get(field)
        array.flags.writeable = False
        return array

    @property
    def positions(self) -> FloatArray:
        """Centres of shape (N, 3), in units. Can be set, and written to until the next step."""
        return self._field("position")

    @positions.setter
    def positions(self, value: npt.ArrayLike) -> None:
        self._set_field("position", value)

    @property
    def velocities(self) -> FloatArray:
        """Velocities of shape (N, 3), in units/s. Can be set, and written to until the next step."""
        return self._field("velocity")

    @velocities.setter
    def velocities(self, value: npt.ArrayLike) -> None:
        self._set_field("velocity", value)

    @property
    def orientations(self) -> FloatArray:
        """Unit quaternions w, x, y, z of shape (N, 4). Can be set, and written to until the next step."""
        return self._field("orientation")

    @orientations.setter
    def orientations(self, value: npt.ArrayLike) -> None:
        self._set_field("orientation", value)

    @property
    def angular_momenta(self) -> FloatArray:
        """Angular momenta of shape (N, 3), in mass units²/s. Can be set, and written to until the next step."""
        return self._field("angular_momentum")

    @angular_momenta.setter
    def angular_momenta(self, value: npt.ArrayLike) -> None:
        self._set_field("angular_momentum", value)

    @property
    def external_forces(self) -> FloatArray:
        """External forces of shape (N, 3), in mass units/s². They act until they are changed."""
        return self._field("force")

    @external_forces.setter
    def external_forces(self, value: npt.ArrayLike) -> None:
        self._set_field("force", value)

    @property
    def radii(self) -> FloatArray:
        """Radii of shape (N,), in units. Read-only."""
        return self._constant("radius")

    @property
    def masses(self) -> FloatArray:
        """Masses of shape (N,). Read-only."""
        return self._constant("mass")

    @property
    def fixed(self) -> npt.NDArray[np.bool_]:
        """Whether each sphere is fixed, of shape (N,). Read-only."""
        array = self._native.get("fixed") != 0
        array.flags.writeable = False
        return array

    @property
    def sphere_ids(self) -> IntArray:
        """Number of each sphere, of shape (N,): row k of :attr:`positions` is the sphere with number ``sphere_ids[k]``."""
        ids: IntArray = self.table("sphere")["id"].copy()
        return ids

    def set(
        self,
        ids: npt.ArrayLike,
        *,
        position: npt.ArrayLike | None = None,
        velocity: npt.ArrayLike | None = None,
        orientation: npt.ArrayLike | None = None,
        angular_momentum: npt.ArrayLike | None = None,
        force: npt.ArrayLike | None = None,
    ) -> None:
        """Set the state of spheres.

        Parameters
        ----------
        ids : array_like of int, shape (M,) or ()
            Numbers of the spheres.
        position, velocity, angular_momentum, force : array_like, shape (M, 3) or (3,), optional
            New values, in units, units/s, mass units²/s and mass units/s².
        orientation : array_like, shape (M, 4) or (4,), optional
            Unit quaternions w, x, y, z.

        Raises
        ------
        ValueError, TypeError
            For wrong shapes and numbers that are not finite. Nothing is set then.
        LookupError
            For a sphere that does not exist.
        """
        numbers = integers("ids", ids)
        given = {"position": position, "velocity": velocity, "angular_momentum": angular_momentum, "force": force}
        arrays = {name: floats(name, value, (3,), len(numbers)) for name, value in given.items() if value is not None}
        if orientation is not None:
            arrays["orientation"] = quaternions("orientation", orientation, len(numbers))
        self._commit()
        for name, rows in arrays.items():
            self._native.set(name, numbers, rows)

    def apply_impulse(self, ids: npt.ArrayLike, impulse: npt.ArrayLike) -> None:
        """Apply impulses to spheres, in mass units/s: each velocity changes by impulse / mass.

        Parameters
        ----------
        ids : array_like of int, shape (M,) or ()
            Numbers of the spheres. Fixed spheres do not change.
        impulse : array_like, shape (M, 3) or (3,)
            Impulses, in mass units/s.
        """
        numbers = integers("ids", ids)
        rows = floats("impulse", impulse, (3,), len(numbers))
        self._commit()
        self._native.set("impulse", numbers, rows)

    @property
    def state(self) -> State:
        """The memory of the CPU backend as read-only views, without copies; see :class:`State`.

        Raises
        ------
        SimulationError
            On the GPU backend.
        """
        self._commit()
        found = self._native.state()
        if found is None:
            raise _rockfall.SimulationError("state: the memory is on the GPU; use positions and the other arrays, or backend=\"cpu\"")
        return State(*found)

    @property
    def scene(self) -> Scene:
        """A copy of the scene with the current state. Its objects are numbered from 0."""
        self._commit()
        return Scene._of(self._native.scene())

    # Observation

    @property
    def energy(self) -> Energy:
        """Energies and momenta of the current state."""
        self._commit()
        found = _rockfall.energy(self._native)
        found["momentum"] = tuple(found["momentum"])
        found["angular_momentum"] = tuple(found["angular_momentum"])
        return Energy(**found)

    @property
    def contacts(self) -> np.ndarray:
        """All contacts of the current state, as a structured array with one row per contact.

        Fields: ``a_kind``, ``a``, ``b_kind`` and ``b`` (kind and row of both bodies, in order of addition), ``point`` (3) and
        ``overlap`` in units, ``normal`` (3) from A to B, ``force`` (3) on B in mass units/s² and ``impulse`` (3) on B in mass
        units/s, of which one is zero.
        """
        self._commit()
        whole_numbers, real = _rockfall.contacts(self._native)
        found = np.zeros(len(whole_numbers), dtype=CONTACT)
        for place, body in enumerate(("a", "b")):
            found[f"{body}_kind"] = BODY_KINDS[whole_numbers[:, 2 * place]]
            found[body] = whole_numbers[:, 2 * place + 1]
        found["point"], found["normal"], found["overlap"] = real[:, :3], real[:, 3:6], real[:, 9]
        is_impulse = whole_numbers[:, 4:] != 0
        found["impulse"] = np.where(is_impulse, real[:, 6:9], 0)
        found["force"] = np.where(is_impulse, 0, real[:, 6:9])
        return found

    @property
    def diagnostics(self) -> np.ndarray:
        """Number of contacts, net force (3) in mass units/s² and deepest overlap in units of every sphere.

        A structured array of shape (N,) with the fields ``contacts``, ``net_force`` and ``deepest_overlap``.
        """
        self._commit()
        contacts, forces, overlaps = _rockfall.diagnostics(self._native)
        found = np.empty(len(contacts), dtype=DIAGNOSTICS)
        found["contacts"], found["net_force"], found["deepest_overlap"] = contacts, forces, overlaps
        return found

    def _overlap(self, resting: bool) -> Overlap:
        self._commit()
        units, radii, bodies = _rockfall.max_overlap(self._native, resting)
        return Overlap(units, radii, None if bodies is None else (tuple(bodies[0]), tuple(bodies[1])))

    @property
    def max_overlap(self) -> Overlap:
        """The deepest overlaps of the current state."""
        return self._overlap(False)

    @property
    def resting_overlap(self) -> Overlap:
        """The deepest overlaps between bodies at rest."""
        return self._overlap(True)

    def cast_rays(self, origin: npt.ArrayLike, direction: npt.ArrayLike) -> np.ndarray:
        """The first body that each ray enters.

        Parameters
        ----------
        origin, direction : array_like, shape (M, 3) or (3,)
            Origins in units, and directions of any length except 0.

        Returns
        -------
        ndarray, structured, shape (M,)
            Fields ``kind`` and ``index`` (row in order of addition), ``distance`` and ``point`` (3) in units, and ``normal`` (3).
            A ray that enters nothing has kind "", index -1, an infinite distance, and NaN.
        """
        self._commit()
        count = max(len(floats("origin", origin, (3,))), len(floats("direction", direction, (3,))))
        origins, directions = floats("origin", origin, (3,), count), floats("direction", direction, (3,), count)
        zero = ~directions.any(axis=1)
        if zero.any():
            row = int(np.flatnonzero(zero)[0])
            raise ValueError(f"direction: expected vectors that are not zero, got [0, 0, 0] at row {row}")
        whole_numbers, real = _rockfall.cast_rays(self._native, origins, directions)
        found = np.empty(count, dtype=RAY_HIT)
        found["kind"], found["index"] = BODY_KINDS[whole_numbers[:, 0]], whole_numbers[:, 1]
        found["distance"], found["point"], found["normal"] = real[:, 0], real[:, 1:4], real[:, 4:]
        return found

    # Files

    def save_checkpoint(self, path: str | os.PathLike[str]) -> None:
        """Write everything that determines the following steps to a file, for :meth:`resume` and ``rockfall run --resume``."""
        self._commit()
        self._native.save_checkpoint(os.fspath(path))

    def restore(self, path: str | os.PathLike[str]) -> None:
        """Replace the state by that of a checkpoint. The backend and the options stay. Objects are numbered from 0 again."""
        self._commit()
        self._native.restore(os.fspath(path))

    def record(self, path: str | os.PathLike[str], every: int = 1) -> Recording:
        """Begin a trajectory that :meth:`run` and :meth:`step` add frames to: now, and after every ``every``-th step.

        Parameters
        ----------
        path : path
            A name that ends in ``.npz`` (NumPy), ``.pvd`` (ParaView) or ``.csv``.
        every : int
            Number of steps from frame to frame.

        Returns
        -------
        Recording
            A context manager, which completes the file at its end.

        Examples
        --------
        >>> with sim.record("column.npz", every=10):  # doctest: +SKIP
        ...     sim.run(1000)
        """
        recording = Recording(self, path, every)
        self._recordings.append(recording)
        return recording

    # Pictures

    def render(
        self,
        size: tuple[int, int] = (1280, 720),
        *,
        colour_by: str | None = None,
        range: tuple[float, float] | None = None,
        camera: npt.ArrayLike | None = None,
        look_at: npt.ArrayLike | None = None,
        plain: bool = False,
    ) -> Picture:
        """Draw the current state. The picture shows itself in a notebook.

        Parameters
        ----------
        size : (int, int)
            Width and height, in pixels.
        colour_by : str, optional
            What colours show, with a legend: kind, speed, contacts, overlap, force, body or contact-force.
        range : (float, float), optional
            Values at the ends of the colour scale; by default from 0 to about the 99th percentile.
        camera : array_like, shape (3,), optional
            Position of the camera, in units; by default chosen so that all bodies are in view.
        look_at : array_like, shape (3,), optional
            Point in the middle of the picture, in units.
        plain : bool
            Whether to draw without shadows and ambient occlusion.

        Raises
        ------
        ValueError
            For a wrong size, an unknown ``colour_by``, or a camera at the point it looks at.
        SimulationError
            If there is no graphics adapter. Software Vulkan is enough.
        """
        sides = np.shape(size)
        if sides != (2,):
            raise ValueError(f"size: expected width and height, got {size!r}")
        width, height = (whole("size", side, least=1) for side in size)
        if max(width, height) > 1 << 16:
            raise ValueError(f"size: expected sides up to {1 << 16} pixels, got {width}x{height}")
        points = [
            None if value is None else [float(number) for number in _one_row(name, value)]
            for name, value in (("camera", camera), ("look_at", look_at))
        ]
        ends = None
        if range is not None:
            if np.shape(range) != (2,) or not range[0] < range[1]:
                raise ValueError(f"range: expected two numbers, the first less than the second, got {range!r}")
            ends = [float(end) for end in floats("range", range, ())]
        self._commit()
        if self._studio is None:
            self._studio = _rockfall.Studio()
        return Picture(self._studio.take(self._native, (width, height), colour_by, ends, points[0], points[1], bool(plain)))

    def __repr__(self) -> str:
        report = self.report
        return f"<rockfall.Simulation: {self.counts.spheres} spheres, step {report.steps}, {report.time:g} s, {self.backend.kind}>"


def _one_row(name: str, value: Any) -> FloatArray:
    rows = floats(name, value, (3,))
    if len(rows) != 1:
        raise ValueError(f"{name}: expected shape (3,), got {rows.shape}")
    return rows[0]


__all__ = ["Settings", "Simulation"]
