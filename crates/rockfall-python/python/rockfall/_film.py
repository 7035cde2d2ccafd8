"""Films."""

from __future__ import annotations

import base64
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

import numpy.typing as npt

from rockfall._attributes import keywords
from rockfall._filming import Shot, played, rehearsed, watched
from rockfall._look import look
from rockfall._picture import Picture
from rockfall.typing import ColourName, UpName

if TYPE_CHECKING:
    from rockfall._simulation import Simulation
    from rockfall._trajectory import Trajectory
    from rockfall._worlds import Worlds

    Filmed = TypeVar("Filmed", Simulation, Worlds, Trajectory)

#: Most pictures per second of a GIF, whose times are in hundredths of a second.
_GIF_FPS = 50


class Film:
    """The pictures of a simulation over some time. It shows itself as a video in a notebook.

    ``len(film)`` is the number of pictures, ``film[k]`` is picture k, and a loop goes through all of them.
    """

    __slots__ = ("_data", "_fps", "_native", "_size")

    def __init__(self, native: Any, fps: int, size: tuple[int, int]) -> None:
        self._native = native
        self._fps = fps
        self._size = size
        self._data: dict[str, bytes] = {}

    @property
    def fps(self) -> int:
        """Pictures per second."""
        return self._fps

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, in pixels."""
        return self._size

    @property
    def duration(self) -> float:
        """Length of the film, in s."""
        return len(self) / self._fps

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the film to a file, or its pictures to a folder.

        Parameters
        ----------
        path : path
            A name that ends in ``.mp4``, ``.webm``, ``.gif`` or ``.apng``, or a folder name that ends in ``/``. MP4 and WebM
            need the program ``ffmpeg``.

        Raises
        ------
        ValueError
            For another name, or a GIF with more than 50 pictures per second.
        OSError
            If the file cannot be written, or ``ffmpeg`` is not installed.
        """
        self._native.save(os.fspath(path), self._fps)

    def __len__(self) -> int:
        return int(self._native.len())

    def __getitem__(self, index: int) -> Picture:
        place = index.__index__()
        count = len(self)
        if not -count <= place < count:
            raise IndexError(f"index: expected a number from {-count} to {count - 1}, got {place}")
        return Picture(self._native.picture(place % count))

    def __iter__(self) -> Iterator[Picture]:
        return (self[index] for index in range(len(self)))

    def _bytes(self, extension: str) -> bytes:
        data = self._data.get(extension)
        if data is None:
            with tempfile.TemporaryDirectory() as folder:
                path = os.path.join(folder, f"film.{extension}")
                self.save(path)
                with open(path, "rb") as file:
                    data = file.read()
            self._data[extension] = data
        return data

    def _repr_html_(self) -> str:
        width, height = self._size
        shape = f'width="{width}" height="{height}" style="max-width: 100%; height: auto"'
        if shutil.which("ffmpeg") is not None:
            data = base64.b64encode(self._bytes("mp4")).decode()
            return f'<video {shape} controls loop autoplay muted src="data:video/mp4;base64,{data}"></video>'
        # Browsers show these without an encoder.
        extension, kind = ("gif", "image/gif") if self._fps <= _GIF_FPS else ("apng", "image/apng")
        data = base64.b64encode(self._bytes(extension)).decode()
        return f'<img {shape} src="data:{kind};base64,{data}">'

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, str]:
        return {"text/html": self._repr_html_(), "text/plain": repr(self)}

    def __repr__(self) -> str:
        width, height = self._size
        return f"<rockfall.Film {width}x{height}, {len(self)} pictures, {self.duration:g} s>"


@keywords
def film(
    sim: Filmed,
    steps: int | None = None,
    fps: int = 25,
    *,
    speed: float | None = None,
    size: tuple[int, int] = (1280, 720),
    colour_by: ColourName | None = None,
    range: tuple[float, float] | None = None,
    camera: npt.ArrayLike | None = None,
    look_at: npt.ArrayLike | None = None,
    follow: int | str | None = None,
    orbit: float = 0.0,
    view: str | None = None,
    up: UpName = "auto",
    plain: bool = False,
    title: str | None = None,
    clock: bool = False,
    scale_bar: bool = False,
    label: bool = False,
    arrows: str | None = None,
    trails: float | str = 0.0,
    plot: str | Sequence[str] = (),
    on_step: Callable[[Filmed], object] | None = None,
    world: int | None = None,
    progress: bool = False,
) -> Film:
    """Run steps of a simulation or of worlds and film them, or film a trajectory.

    The simulation is then in the same state as after ``sim.run(steps)``. Pictures between two steps, or between two frames of a
    trajectory, show positions in between.
    :func:`rockfall.gym.film` films an environment of Gymnasium.

    Parameters
    ----------
    sim : Simulation, Worlds or Trajectory
        The simulation, or the worlds, of which all advance. The film starts in the current state. Or a trajectory, all of which is
        shown: ``film(trajectory[20:])`` begins with frame 20.
    steps : int, optional
        Number of steps; none for a trajectory.
    fps : int
        Pictures per second, up to 1000.
    speed : float, optional
        Simulated seconds per second of film: 1 is real time, less is slow motion. By default that of the scene
        (``scene.run.speed``), else 1.
    size : (int, int)
        Width and height, in pixels.
    colour_by : str, optional
        What colours show, with a legend: kind, speed, contacts, overlap, force, body, contact-force or tension.
    range : (float, float), optional
        Values at the ends of the colour scale; by default one that fits all pictures.
    camera : array_like, shape (3,), optional
        Position of the camera, in units; by default chosen so that all that happens is in view.
    look_at : array_like, shape (3,), optional
        Point in the middle of the pictures, in units.
    follow : int or str, optional
        Number of a sphere, or a name in the scene, that stays in the middle of the pictures, instead of ``look_at``.
    orbit : float
        Turns the camera around the middle of the pictures, in degrees per second of film.
    view : str, optional
        Direction from which the camera looks: front, side, top or iso; by default obliquely from above.
    up : str
        Axis to the top of the picture: y, z or auto, which is opposite to gravity if that is along an axis, else y.
    plain : bool
        Whether to draw without shadows and ambient occlusion.
    title : str, optional
        Text at the upper edge.
    clock : bool
        Whether to show the time of the simulation.
    scale_bar : bool
        Whether to show the length of a round number of units at the distance of the middle of the picture.
    label : bool
        Whether to write its number on every sphere.
    arrows : str, optional
        What an arrow at every sphere shows, with a key: velocity, force or gravity.
    trails : float or str
        Length of the trails of the bodies, in s of the simulation, or with the names or numbers of those that have one, as in
        ``"2:left,7"``.
    plot : str or sequence of str
        Quantities over time beside the picture: ``"energy"``, ``"kinetic"``, ``"potential"``, ``"momentum"``, ``"contacts"``, or
        height, speed, x, y, z, vx, vy or vz of bodies by their names or numbers, as in ``"height:left,right"``, the size of the
        force on walls by the names of gauges, as in ``"gauge:weight"``, or joints by their names or numbers: the position in
        degrees or units, as in ``"joint:door"``, or their speed, force or torque, as in ``"joint:door.speed"``.
    on_step : callable, optional
        ``on_step(sim)`` is called after every step, for example to set forces. The steps are then run once.
    world : int, optional
        Number of the world that is filmed, of worlds; by default 0.
    progress : bool
        Whether to show a progress bar, by tqdm where it is installed.

    Returns
    -------
    Film
        The film, in memory. ``film.save("film.mp4")`` writes it to a file.

    Raises
    ------
    ValueError
        For a value that is not allowed, and while a trajectory is recorded.
    LookupError
        For a sphere to follow or a world that does not exist.
    SimulationError
        If there is no graphics adapter (software Vulkan is enough), or as :meth:`Simulation.run`.
    KeyboardInterrupt
        After Ctrl-C. The simulation is between two steps and can go on.

    Notes
    -----
    The steps are run twice: first to find out what happens, then for the pictures. They are run once if ``camera``, ``look_at``
    (or ``follow``) and the colour scale are given and there are no boxes and polygons, which may hide bodies.

    With ``on_step`` the steps are run once, because a second run might differ from the first. What happens is then not known
    before: the camera and the walls that are left out fit the first state, and each picture has a colour scale of its own, unless
    ``camera``, ``look_at`` and ``range`` are given. The same holds for worlds that stand still while they sleep.

    Examples
    --------
    >>> rf.film(sim, 500, fps=30, colour_by="speed").save("fall.mp4")  # doctest: +SKIP
    >>> def push(sim):
    ...     sim.external_forces = -5 * sim.positions
    >>> rf.film(sim, 500, on_step=push)  # doctest: +SKIP
    """
    captions: dict[str, Any] = {"title": title, "clock": clock, "scale_bar": scale_bar, "label": label, "arrows": arrows}
    shown = look(size, colour_by, range, camera, look_at, plain, view=view, up=up, trails=trails, plot=plot, **captions)
    native, shot = _taken(sim, shown, (steps, fps, speed, follow, orbit), on_step, world, progress)
    return Film(native, shot.fps, shown["size"])


def _taken(
    sim: Any, shown: dict[str, Any], timing: tuple[Any, ...], on_step: Callable[[Any], object] | None, world: Any, progress: bool
) -> tuple[Any, Shot]:
    """The native film of a simulation or of a world."""
    from rockfall._simulation import Simulation
    from rockfall._trajectory import Trajectory
    from rockfall._worlds import Worlds

    if isinstance(sim, Trajectory):
        return _of_trajectory(sim, shown, timing, on_step, world, progress)
    if not isinstance(sim, (Simulation, Worlds)):
        expected = "a rockfall.Simulation, rockfall.Worlds or rockfall.Trajectory"
        raise TypeError(f"sim: expected {expected}, got {type(sim).__name__}")
    steps, fps, *others = timing
    if steps is None:
        raise TypeError("steps: expected the number of steps, got None")
    shot = Shot.checked(shown, steps, sim.dt, fps, *others)
    if on_step is not None and not callable(on_step):
        raise TypeError(f"on_step: expected a function, got {type(on_step).__name__}")
    if isinstance(sim, Worlds):
        return _of_world(sim, sim._world(0 if world is None else world), shot, on_step, progress), shot
    if world is not None:
        raise TypeError("world: expected None for a Simulation")
    if sim._recordings:
        raise ValueError("sim: a trajectory is being recorded, and a film has no frames for it; finish the recording first")
    if on_step is not None:
        return watched(sim, sim._committed, shot, on_step, progress), shot
    sim._check()
    return rehearsed(sim._committed(), shot, progress), shot


def _of_trajectory(
    trajectory: Trajectory, shown: dict[str, Any], timing: tuple[Any, ...], on_step: Any, world: Any, progress: bool
) -> tuple[Any, Shot]:
    """The native film of a trajectory, whose steps are its frames."""
    from rockfall._trajectory import Shown

    steps, fps, *others = timing
    for name, value in (("steps", steps), ("on_step", on_step), ("world", world)):
        if value is not None:
            raise TypeError(f"{name}: expected None for a Trajectory, which has its steps; trajectory[20:40] is a part of it")
    states = Shown(trajectory)
    if not states.interval > 0.0:
        raise ValueError("trajectory: expected frames at several times")
    shot = Shot.checked(shown, len(trajectory) - 1, states.interval, fps, *others)
    return played(states, len(trajectory), shot, progress), shot


def _of_world(worlds: Worlds, world: int, shot: Shot, on_step: Callable[[Any], object] | None, progress: bool) -> Any:
    # A world that is stopped, or stands still while it sleeps, does not move as a simulation does.
    if on_step is not None or worlds.sleep["skip"] or world in worlds.stopped:
        return watched(worlds, lambda: worlds._alone(world), shot, on_step, progress)
    film = rehearsed(worlds.simulation(world)._native, shot, progress)
    worlds.run(shot.steps)
    return film
