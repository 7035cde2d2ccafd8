"""Simulations."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from rockfall import _rockfall
from rockfall._arrays import time_step, whole
from rockfall._contact_law import ContactLaw, ContactLawOf, native_contact_law
from rockfall._flow import Flow, Inflow, Outflow
from rockfall._joints import JointStates
from rockfall._laws import ForceLaw, LawTable, native_laws
from rockfall._look import look, warn_of_letters
from rockfall._motions import PlaneFlow, WallLoad, motion_term
from rockfall._picture import Picture
from rockfall._progress import Progress
from rockfall._reports import Backend, Profile, Report, StageTime
from rockfall._scene import Scene
from rockfall._stored import Stored
from rockfall._team import Communicator, handle_of
from rockfall._vtk import to_pyvista
from rockfall._warnings import warn
from rockfall.typing import BackendName, BroadPhaseName, ColourName, IntegratorName, UpName

if TYPE_CHECKING:
    import pyvista


class SceneWarning(UserWarning):
    """A time step or constants do not suit a scene, so that results are likely wrong. :meth:`Scene.check` lists the same."""


class Simulation(Stored, LawTable, ContactLawOf):
    """A scene that advances in time.

    Parameters
    ----------
    scene : Scene
        The scene, of which the simulation takes a copy.
    dt : float, optional
        Time step, in s. It can be changed later. By default it is that of the scene (:attr:`Scene.run`), or 0.02.
    backend : {"auto", "gpu", "cpu"}
        "auto" uses the CPU for up to 64 spheres and rods, otherwise a hardware GPU where there is one.
    device : int, optional
        Number of the GPU, from 0, in the list of :func:`devices`. By default the best one. Not with the backend "cpu".
    integrator : {"auto", "rk4", "symplectic-euler", "velocity-verlet"}
        How positions and velocities are advanced. "auto" is that of the scene (:attr:`Scene.run`) if it has one,
        "velocity-verlet" with the contact laws "linear",
        "hertz-mindlin" and "user", which do not allow "rk4", and otherwise "rk4".
    broad_phase : {"auto", "brute-force", "sort-and-skip", "grid"}
        How pairs that may touch are found. Results do not depend on it.
    keep_going : bool
        Whether to continue when the state of a body stops being finite. The body is then stopped and counted in
        :attr:`report`.
    check : bool
        Whether the first steps with a time step warn (:class:`SceneWarning`) of what :meth:`Scene.check` finds: a time step that
        is too long, bodies that will sink into each other, and similar.
    force_laws : iterable of ForceLaw
        Forces that the program defines, in the order in which they act. :meth:`add_force_law` adds more.
    contact_law : ContactLaw, optional
        The contact law that the program defines. It takes the place of that of the scene, as ``contact_law = "user"`` in its
        settings, and so switches ``collisions`` off.
    comm : mpi4py.MPI.Comm, optional
        The processes that share the simulation, such as ``MPI.COMM_WORLD``: each computes a part of the scene, with the bits of a
        simulation without ``comm``. See Notes.

    Raises
    ------
    ValueError
        For a value that is not allowed, and with ``comm`` for a scene that processes cannot share, such as one with rods.
    SimulationError
        If there is no GPU for ``backend="gpu"``, or the scene is too large. With ``comm``, also if this package was built without
        MPI, if MPI was not started with ``MPI_THREAD_MULTIPLE`` (the default of mpi4py) or has ended, or if another process failed.

    Notes
    -----
    Arrays such as :attr:`positions` are copies in order of addition. They belong to the state in which they were read:

    - Writing to one changes the simulation. The change takes effect before the next step, edit or read.
    - With the next step or edit it becomes a read-only snapshot, which keeps its values. Read the attribute again for the new
      state.

    So ``sim.velocities[:] = 0`` stops all bodies, and ``moved = sim.positions - before`` is what it seems to be. Call
    ``.copy()`` for an array to compute in.

    On the GPU backend of an NVIDIA card under Linux, arrays are :class:`DeviceArray`. PyTorch and CuPy read and write them
    without a copy through the host:

    >>> positions = torch.from_dlpack(sim.positions)    # doctest: +SKIP
    >>> sim.external_forces = -positions.contiguous()   # doctest: +SKIP

    Several threads may use a simulation. They wait for each other, without the GIL.

    With ``comm``, all processes of the communicator make the same calls in the same order, with the same arguments: they make the
    simulation of the same scene, run the same steps, and read the state together, because the first read after a step gathers it.
    Further reads until the next step need no other process. So read before ``if comm.rank == 0:``, and use the result in it. Different
    calls raise :class:`SimulationError`, or wait for ever where a process makes no further call. :attr:`steps`, :attr:`time` and
    :attr:`dt` may be read by any process. Every process then has the whole state. Files are written by the first
    process. Arrays are read-only, and what changes, copies or films the simulation raises ValueError. Start the program with
    ``mpirun -n 4 python -m mpi4py program.py``, which ends all processes when one of them raises an error that it does not catch.

    The simulation uses a duplicate of the communicator. ``docs/cluster.md`` describes how to build with MPI, what scenes can be shared, and
    which GPU a process has.
    """

    def __init__(
        self,
        scene: Scene,
        dt: float | None = None,
        *,
        backend: BackendName = "auto",
        device: int | None = None,
        integrator: IntegratorName = "auto",
        broad_phase: BroadPhaseName = "auto",
        keep_going: bool = False,
        check: bool = True,
        force_laws: Iterable[ForceLaw] = (),
        contact_law: ContactLaw | None = None,
        comm: Communicator | None = None,
    ) -> None:
        if not isinstance(scene, Scene):
            raise TypeError(f"scene: expected a rockfall.Scene, got {type(scene).__name__}")
        for name, value in (("backend", backend), ("integrator", integrator), ("broad_phase", broad_phase)):
            if not isinstance(value, str):
                raise TypeError(f"{name}: expected a str, got {type(value).__name__}")
        step = scene._time_step(dt)
        laws = native_laws(force_laws)
        contact = native_contact_law(contact_law)
        number = None if device is None else whole("device", device)
        methods = (backend, number, integrator, broad_phase, bool(keep_going))
        native = _rockfall.Simulation(scene._native, methods, laws, contact, handle_of(comm))
        self._begin(native, step, checked=None if check else step)

    def _begin(self, native: Any, dt: float, checked: float | None) -> None:
        self._native = native
        self._dt = dt
        native.set_time_step(dt)
        self._checked = checked
        self._live = {}
        self._recordings = []
        self._studio: Any = None

    @classmethod
    def _of(cls, native: Any, dt: float) -> Simulation:
        """A simulation from a native one, whose scene was checked before."""
        simulation = cls.__new__(cls)
        simulation._begin(native, dt, checked=dt)
        return simulation

    @classmethod
    def resume(
        cls,
        path: str | os.PathLike[str],
        *,
        backend: BackendName | None = None,
        force_laws: Iterable[ForceLaw] = (),
        contact_law: ContactLaw | None = None,
        comm: Communicator | None = None,
    ) -> Simulation:
        """Continue from a checkpoint, with results that are bitwise identical to those of a run that never stopped.

        Objects are numbered from 0 again.

        Parameters
        ----------
        path : path
            A file that :meth:`save_checkpoint` or ``rockfall run --checkpoint`` wrote.
        backend : {"auto", "gpu", "cpu"}, optional
            Another backend than that of the checkpoint. Results then differ by rounding.
        force_laws : iterable of ForceLaw
            All force laws that the simulation had. Their parameters get the values of the checkpoint.
        contact_law : ContactLaw, optional
            The contact law that the program had defined. Its parameters get the values of the checkpoint.
        comm : mpi4py.MPI.Comm, optional
            The processes that share the simulation from now on, in any number. All of them read the file.

        Raises
        ------
        OSError
            If the file cannot be read.
        ValueError
            If it is not a usable checkpoint, or if a law is missing or another one. With ``comm``, as for :class:`Simulation`.
        SimulationError
            As for :class:`Simulation`.
        """
        laws, contact = native_laws(force_laws), native_contact_law(contact_law)
        native = _rockfall.Simulation.resume(os.fspath(path), backend, laws, contact, handle_of(comm))
        # The decimal number that was written as f32.
        return cls._of(native, float(str(np.float32(native.time_step()))))

    # Steps

    def _check(self) -> None:
        """Warns of what does not suit the time step, once; of processes that share the simulation, the first."""
        if self._checked != self._dt:
            self._checked = self._dt
            if self._native.rank():
                return
            for concern in self._native.concerns(self._dt):
                warn(f"time step {self._dt} s: {concern}", SceneWarning)

    @property
    def dt(self) -> float:
        """Time step, in s."""
        return self._dt

    @dt.setter
    def dt(self, value: float) -> None:
        self._dt = time_step("dt", value)
        self._native.set_time_step(self._dt)

    def move(
        self,
        motion: str,
        *,
        velocity: npt.ArrayLike = (0.0, 0.0, 0.0),
        spin: float = 0.0,
        axis: npt.ArrayLike = (0.0, 0.0, 1.0),
        through: npt.ArrayLike = (0.0, 0.0, 0.0),
        amplitude: npt.ArrayLike = (0.0, 0.0, 0.0),
        frequency: float = 0.0,
        phase: float = 0.0,
        end: float = np.inf,
    ) -> None:
        """Replace a motion from now on, without a jump: walls go on from where they are.

        The arguments are those of :meth:`add_motion`; directions and axis are those of the world. Without any, the walls stop.

        Raises
        ------
        LookupError
            For an unknown motion.
        ValueError
            As for :meth:`add_motion`.
        """
        self._edited()
        _rockfall.go_on(self._native, motion, motion_term(velocity, spin, axis, through, amplitude, frequency, phase, 0.0, end))

    def wall_load(self, name: str) -> WallLoad:
        """The load of all contacts on walls, as a gauge would measure it.

        Parameters
        ----------
        name : str
            Name of the walls, or of the motion that they follow.

        Returns
        -------
        WallLoad
            Force in mass units/s², torque about the origin in mass units²/s², and number of contacts. A collision counts with its
            impulse divided by the time step. Friction impulses are left out.

        Raises
        ------
        ValueError
            If no box and no polygon has this name or motion.
        """
        self._commit()
        force, torque, contacts = _rockfall.wall_load(self._native, name)
        return WallLoad(np.array(force), np.array(torque), contacts)

    @property
    def gauges(self) -> dict[str, WallLoad | PlaneFlow]:
        """What the gauges measure in the current state, by name. See :meth:`add_gauge` and :meth:`wall_load`.

        Raises
        ------
        ValueError
            If the walls of a gauge were removed.
        """
        self._commit()
        found: dict[str, WallLoad | PlaneFlow] = {}
        for name, (load, flow) in _rockfall.gauges(self._native):
            if load is not None:
                found[name] = WallLoad(np.array(load[0]), np.array(load[1]), load[2])
            elif flow is not None:
                found[name] = PlaneFlow(*flow)
        return found

    @property
    def joints(self) -> JointStates:
        """What all joints do at present: ``joints.positions``, ``speeds``, ``forces``, ``torques``, ``errors`` and ``broken``."""
        return JointStates(self)

    @property
    def flow(self) -> Flow:
        """What came in through inlets and left through outlets since the start, and what is inside.

        In a scene to which the program adds nothing, what came in minus what left is the change of what is inside, exactly.
        """
        inlets, outlets, spheres, mass = _rockfall.flow(self._native)
        came = {name: Inflow(count, total, waiting) for name, count, total, waiting in inlets}
        left = {name: Outflow(count, total) for name, count, total, _ in outlets}
        return Flow(came, left, spheres, mass)

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
            After Ctrl-C. The simulation is between two steps and can go on. With ``comm``, all processes raise it.

        Notes
        -----
        Other threads of Python run meanwhile.
        """
        left = whole("steps", steps)
        if left > 0:
            self._check()
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
        self._check()
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
        """Run steps and measure the time of every stage. It takes longer than :meth:`run`, and raises as it."""
        self._commit()
        found = self._native.profile(whole("steps", steps, least=1), self._dt)
        found["stages"] = [StageTime(*stage) for stage in found["stages"]]
        return Profile(**found)

    @property
    def steps(self) -> int:
        """Number of steps done."""
        steps: int = self._native.elapsed()[0]
        return steps

    @property
    def time(self) -> float:
        """Time simulated, in s."""
        time: float = self._native.elapsed()[1]
        return time

    @property
    def report(self) -> Report:
        """Counts and times of all steps so far.

        With ``comm``, ``replays`` and ``list_builds`` are those before the processes shared the simulation.
        """
        return Report(**self._native.report())

    @property
    def backend(self) -> Backend:
        """The backend that runs the simulation, and why it was chosen."""
        return Backend(**self._native.backend())

    @property
    def array_sharing(self) -> str:
        """How arrays reach PyTorch, CuPy and other libraries on the GPU.

        "device" if they share the memory of the device by DLPack, otherwise "host: " and the reason why they are copied through
        the host.
        """
        reason = self._native.not_shared()
        return "device" if reason is None else f"host: {reason}"

    @property
    def integrator(self) -> str:
        """The integrator: "rk4", "symplectic-euler" or "velocity-verlet"."""
        name: str = self._native.methods()[0]
        return name

    @property
    def broad_phase_method(self) -> str:
        """The method that finds pairs: the requested one, or the one chosen for the number of objects."""
        name: str = self._native.methods()[1]
        return name

    @property
    def memory(self) -> int:
        """Size of the arrays of the simulation, in bytes: on the GPU, or on the CPU backend in host memory."""
        return int(self._native.device_memory())

    @property
    def scene(self) -> Scene:
        """A copy of the scene with the current state. Its objects are numbered from 0."""
        self._commit()
        return Scene._of(self._native.scene())

    def _committed(self) -> Any:
        """The native simulation, with what was written to arrays."""
        self._commit()
        return self._native

    # Pictures

    def render(
        self,
        size: tuple[int, int] = (1280, 720),
        *,
        colour_by: ColourName | None = None,
        range: tuple[float, float] | None = None,
        camera: npt.ArrayLike | None = None,
        look_at: npt.ArrayLike | None = None,
        view: str | None = None,
        up: UpName = "auto",
        plain: bool = False,
        title: str | None = None,
        clock: bool = False,
        scale_bar: bool = False,
        label: bool = False,
        arrows: str | None = None,
        plot: str | Sequence[str] = (),
    ) -> Picture:
        """Draw the current state. The picture shows itself in a notebook.

        Parameters
        ----------
        size : (int, int)
            Width and height, in pixels.
        colour_by : str, optional
            What colours show, with a legend: kind, speed, contacts, overlap, force, body, contact-force or tension.
        range : (float, float), optional
            Values at the ends of the colour scale; by default from 0, or for tension from minus that value, to about the
            99th percentile.
        camera : array_like, shape (3,), optional
            Position of the camera, in units; by default chosen so that all bodies are in view.
        look_at : array_like, shape (3,), optional
            Point in the middle of the picture, in units.
        view : str, optional
            Direction from which the camera looks: front, side, top or iso; by default obliquely from above.
        up : str
            Axis to the top of the picture: y, z or auto, which is opposite to gravity if that is along an axis, else y.
        plain : bool
            Whether to draw without shadows and ambient occlusion.
        title : str, optional
            A line of text at the upper edge.
        clock : bool
            Whether to show the time of the simulation.
        scale_bar : bool
            Whether to show the length of a round number of units at the distance of the middle of the picture.
        label : bool
            Whether to write its number on every sphere.
        arrows : str, optional
            What an arrow at every sphere shows, with a key: velocity, force or gravity.
        plot : str or sequence of str
            Quantities over time beside the picture, as in :func:`rockfall.film`, such as ``"energy"``, the height of bodies by
            their names or numbers, as in ``"height:left,right"``, the size of the force on walls by the names of gauges, as in
            ``"gauge:weight"``, or joints by their names or numbers: the position in degrees or units, as in ``"joint:door"``, or
            their speed, force or torque, as in ``"joint:door.speed"``. A simulation keeps no values of the past: the lines
            go through this state and those of the pictures with the same plots before.

        Raises
        ------
        ValueError
            For a wrong size, an unknown ``colour_by``, ``view``, ``up``, ``arrows`` or ``plot``, or a camera at the point it
            looks at.
        LookupError
            For a body in ``plot`` that does not exist.
        SimulationError
            If there is no graphics adapter. Software Vulkan is enough.
        """
        captions: dict[str, Any] = {"title": title, "clock": clock, "scale_bar": scale_bar, "label": label, "arrows": arrows}
        shown = look(size, colour_by, range, camera, look_at, plain, view=view, up=up, plot=plot, **captions)
        self._commit()
        warn_of_letters(self._native, shown)
        if self._studio is None:
            self._studio = _rockfall.Studio()
        return Picture(self._studio.take(self._native, shown, False))

    def to_pyvista(self) -> pyvista.PolyData:
        """The current state as a data set of PyVista, for plots with VTK.

        Returns
        -------
        pyvista.PolyData
            One point per sphere in order of addition, with the arrays ``id``, ``radius``, ``mass``, ``velocity``, ``orientation``
            (w, x, y, z), ``angular_momentum`` and ``force``. Spheres are vertices, rods and springs are lines; the array
            ``kind`` of the cells is 0 for spheres, 1 for rods and 2 for springs. The field data are ``time`` and ``step``.

        Raises
        ------
        ImportError
            If PyVista is not installed.

        Examples
        --------
        >>> balls = pyvista.Sphere(radius=1.0)  # doctest: +SKIP
        >>> sim.to_pyvista().glyph(geom=balls, scale="radius", orient=False).plot()  # doctest: +SKIP
        """
        return to_pyvista(self)

    def __repr__(self) -> str:
        return f"<rockfall.Simulation: {self.counts.spheres} spheres, step {self.steps}, {self.time:g} s, {self.backend.kind}>"
