"""Checkpoints, recordings and copies of simulations."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, TypeVar, cast

from rockfall import _rockfall
from rockfall._contact_law import ContactLaw, native_contact_law
from rockfall._events import Watched
from rockfall._laws import ForceLaw, native_laws
from rockfall._team import on_first
from rockfall._trajectory import Recording

if TYPE_CHECKING:
    from rockfall._simulation import Simulation

_Self = TypeVar("_Self", bound="Stored")


class Stored(Watched):
    """A state that can be copied and written to files. A base of :class:`Simulation`."""

    _dt: float
    _checked: float | None
    _recordings: list[Recording]

    def _begin(self, native: Any, dt: float, checked: float | None) -> None:
        raise NotImplementedError

    def save_checkpoint(self, path: str | os.PathLike[str]) -> None:
        """Write everything that determines the following steps to a file, for :meth:`resume` and :meth:`restore`.

        Of processes that share the simulation, the first writes. All must call this.

        Raises
        ------
        OSError
            If the file cannot be written. Other processes than the first raise SimulationError.
        """
        self._commit()
        self._native.gather()
        on_first(self._native, lambda: self._native.save_checkpoint(os.fspath(path)))

    def restore(self, path: str | os.PathLike[str]) -> None:
        """Replace the state by that of a checkpoint. The backend and the options stay. Objects are numbered from 0 again.

        Raises
        ------
        OSError, ValueError
            As for :meth:`resume`. ValueError while a trajectory is recorded, in which time would go back.
        """
        if self._recordings:
            raise ValueError("a trajectory is being recorded, in which time cannot go back: finish the recording first")
        self._commit()
        self._native.restore(os.fspath(path))
        self._native.set_time_step(self._dt)

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
            A context manager, which completes the file at its end. Without ``with``, :meth:`Recording.finish` does, or the end of
            the program.

        Notes
        -----
        Spheres may come and go meanwhile. An ``.npz`` file then has the spheres of all frames one after the other, with their numbers in
        the array ``id`` and the beginnings of the frames in ``offsets``. ``.pvd`` files with different spheres cannot be read back.

        Examples
        --------
        >>> with sim.record("column.npz", every=10):  # doctest: +SKIP
        ...     sim.run(1000)
        """
        recording = Recording(cast("Simulation", self), path, every)
        self._recordings.append(recording)
        return recording

    # Copies

    def copy(self: _Self) -> _Self:
        """Another simulation in the same state, on the same backend, which takes the same steps to the same bits.

        Objects have the same numbers in both. Recordings stay with this simulation.

        Raises
        ------
        ValueError
            Between :meth:`handle_collisions` and :meth:`update_positions`, when a step is not complete.
        """
        self._commit()
        twin = type(self).__new__(type(self))
        twin._begin(self._native.copy(), self._dt, self._checked)
        return twin

    def __copy__(self) -> Any:
        raise TypeError("a simulation has no shallow copy: call sim.copy(), which makes an independent simulation in the same state")

    def __deepcopy__(self: _Self, memo: Any) -> _Self:
        return self.copy()

    def __reduce__(self) -> Any:
        # A checkpoint. Numbers of objects start again from 0.
        self._commit()
        laws = (getattr(self, "force_laws"), getattr(self, "contact_law"))
        return (_from_bytes, (type(self), self._native.to_bytes(), self._dt, self._checked, *laws))


def _from_bytes(
    cls: type[_Self], data: bytes, dt: float, checked: float | None, laws: tuple[ForceLaw, ...], contact: ContactLaw | None
) -> _Self:
    simulation = cls.__new__(cls)
    simulation._begin(_rockfall.Simulation.from_bytes(data, native_laws(laws), native_contact_law(contact)), dt, checked)
    return simulation
