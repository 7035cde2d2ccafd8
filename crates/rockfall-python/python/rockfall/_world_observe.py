"""What can be found out about many worlds."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from rockfall import _rockfall
from rockfall._arrays import floats, whole
from rockfall._look import look, warn_of_letters
from rockfall._picture import Picture
from rockfall._reports import ENERGIES, WORLD_REPORTS, Backend
from rockfall._scene import Scene
from rockfall._simulation import SceneWarning, Simulation
from rockfall._tables import contact_table
from rockfall._warnings import warn
from rockfall._world_mechanisms import WorldMechanisms

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from rockfall._options import PictureOptions


#: Most worlds that are checked for unsuitable time steps. A check of one takes about as long as 25 of its steps.
_MOST_CHECKED = 64


class ObservedWorlds(WorldMechanisms):
    """Worlds that are observed. A base of :class:`Worlds`."""

    _dt: float
    #: The time step that was checked last; None to check the next one.
    _checked: float | None
    #: Whether time steps are checked.
    _checks: bool
    _studio: Any

    def report(self, bounds: tuple[npt.ArrayLike, npt.ArrayLike] | None = None) -> npt.NDArray[Any]:
        """Counts and times of all worlds.

        Parameters
        ----------
        bounds : (array_like, array_like), each of shape (3,), optional
            Least and greatest coordinates of the centres of spheres that have not escaped, in units.

        Returns
        -------
        ndarray, structured, shape (W,)
            ``steps``, ``time``, ``contacts``, ``max_overlap``, ``collisions``, ``total_collisions``, ``replays``, ``list_builds`` and
            ``non_finite`` as in :class:`Report`, since the world was created, replaced or reset; ``stopped``, whether the world
            does not advance any more; ``escaped``, the row of the first sphere outside of the bounds, -1 if there is none;
            ``workgroup``, whether a workgroup of the GPU runs the world, side by side with others; ``sleeping``, whether
            everything in it rests (:meth:`set_sleep`).
        """
        limits = None
        if bounds is not None:
            low, high = (floats(f"bounds[{side}]", bounds[side], (3,), 1)[0].tolist() for side in (0, 1))
            limits = [low, high]
        found = self._native.reports(limits)
        table = np.zeros(len(found), WORLD_REPORTS)
        for row, (report, on_device, escaped, stopped, sleeping) in zip(table, found, strict=True):
            # Worlds in one dispatch do not count passages.
            for name in report.keys() & set(WORLD_REPORTS.names or ()):
                row[name] = report[name]
            row["workgroup"] = on_device
            row["escaped"] = -1 if escaped is None else escaped
            row["stopped"] = stopped is not None
            row["sleeping"] = sleeping
        return table

    @property
    def stopped(self) -> dict[int, str]:
        """The worlds that do not advance any more, by number, with the reasons."""
        found = self._native.reports(None)
        return {world: report[3] for world, report in enumerate(found) if report[3] is not None}

    @property
    def backend(self) -> Backend:
        """The backend that runs the worlds, and why it was chosen."""
        return Backend(**self._native.backend())

    @property
    def integrator(self) -> str:
        """The integrator of all worlds: "rk4", "symplectic-euler" or "velocity-verlet"; "auto" where they have different ones."""
        name: str = self._native.integrator()
        return name

    def _check(self) -> None:
        """Warns of what does not suit the time step, once."""
        if not self._checks or self._checked == self._dt:
            return
        self._checked = self._dt
        count = len(self)
        stride = max(1, -(-count // _MOST_CHECKED))
        checked = len(range(0, count, stride))
        for concern, worlds in _rockfall.world_concerns(self._native, self._dt, stride):
            several = f"{len(worlds)} of {checked} worlds{' that were checked' if stride > 1 else ''}, first in world {worlds[0]}"
            where = f"world {worlds[0]}" if len(worlds) == 1 else several
            warn(f"time step {self._dt} s: {concern} (in {where})", SceneWarning)

    @property
    def energies(self) -> npt.NDArray[Any]:
        """Energies and momenta of all worlds, as a structured array of shape (W,).

        Fields: ``kinetic``, ``potential``, ``spring``, ``contact`` and their sum ``total`` in mass units²/s², ``momentum`` (3) in
        mass units/s and ``angular_momentum`` (3) about the origin in mass units²/s, as in :attr:`Simulation.energy`.
        """
        numbers = _rockfall.world_energies(self._native)
        found = np.zeros(len(numbers), ENERGIES)
        for place, name in enumerate(("kinetic", "potential", "spring", "contact")):
            found[name] = numbers[:, place]
        found["total"] = numbers[:, :4].sum(axis=1)
        found["momentum"], found["angular_momentum"] = numbers[:, 4:7], numbers[:, 7:]
        return found

    def contacts(self, world: int) -> npt.NDArray[Any]:
        """All contacts of the current state of a world, as :attr:`Simulation.contacts` gives them."""
        return contact_table(*_rockfall.world_contacts(self._native, self._world(world)))

    def _world(self, world: int) -> int:
        return int(self._numbers(whole("world", world))[0])

    def _alone(self, world: int) -> Any:
        """A native simulation on the CPU with the current state of a world."""
        return _rockfall.world_simulation(self._native, world, "cpu")

    def scene(self, world: int) -> Scene:
        """A scene with the current state of a world, from which a simulation can continue."""
        return Scene._of(self._native.scene(self._world(world)))

    def simulation(self, world: int) -> Simulation:
        """A simulation that goes on where a world is, with the same options, time and step.

        Its steps are bitwise identical to those of the world. It is independent of the world.
        """
        return Simulation._of(_rockfall.world_simulation(self._native, self._world(world), None), self._dt)

    def render(self, world: int, size: tuple[int, int] = (1280, 720), **options: Unpack[PictureOptions]) -> Picture:
        """Draw a world. Arguments are those of :meth:`Simulation.render`."""
        shown = look(size, **options)
        native = self._alone(self._world(world))
        warn_of_letters(native, shown)
        if self._studio is None:
            self._studio = _rockfall.Studio()
        return Picture(self._studio.take(native, shown, True))
