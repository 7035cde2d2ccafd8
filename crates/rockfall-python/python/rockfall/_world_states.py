"""The states of many worlds as arrays."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from rockfall._arrays import FloatArray, IntArray, floats, integers, quaternions
from rockfall._attributes import Strict

#: Fields of spheres with their columns.
STATES = {"positions": ("position", 3), "velocities": ("velocity", 3), "orientations": ("orientation", 4),
           "angular_momenta": ("angular_momentum", 3)}


class WorldStates(Strict):
    """Spheres and springs of many worlds with states that change. A base of :class:`Worlds`."""

    _native: Any

    def __len__(self) -> int:
        return int(self._native.len())

    @property
    def sphere_counts(self) -> IntArray:
        """Number of spheres in each world, of shape (W,)."""
        counts: IntArray = self._native.counts()[0]
        return counts

    @property
    def spring_counts(self) -> IntArray:
        """Number of springs in each world, of shape (W,)."""
        counts: IntArray = self._native.counts()[1]
        return counts

    @property
    def mask(self) -> npt.NDArray[np.bool_]:
        """Which rows of arrays of spheres exist, of shape (W, N)."""
        return mask_of(self.sphere_counts)

    @property
    def spring_mask(self) -> npt.NDArray[np.bool_]:
        """Which rows of arrays of springs exist, of shape (W, M)."""
        return mask_of(self.spring_counts)

    @property
    def positions(self) -> FloatArray:
        """Centres of the spheres of shape (W, N, 3), in units. Can be set."""
        return self._get("position")

    @positions.setter
    def positions(self, value: npt.ArrayLike) -> None:
        self.set(positions=value)

    @property
    def velocities(self) -> FloatArray:
        """Velocities of the spheres of shape (W, N, 3), in units/s. Can be set."""
        return self._get("velocity")

    @velocities.setter
    def velocities(self, value: npt.ArrayLike) -> None:
        self.set(velocities=value)

    @property
    def orientations(self) -> FloatArray:
        """Unit quaternions w, x, y, z of shape (W, N, 4). Can be set."""
        return self._get("orientation")

    @orientations.setter
    def orientations(self, value: npt.ArrayLike) -> None:
        self.set(orientations=value)

    @property
    def angular_momenta(self) -> FloatArray:
        """Angular momenta of shape (W, N, 3), in mass units²/s. Can be set."""
        return self._get("angular_momentum")

    @angular_momenta.setter
    def angular_momenta(self, value: npt.ArrayLike) -> None:
        self.set(angular_momenta=value)

    @property
    def external_forces(self) -> FloatArray:
        """External forces of shape (W, N, 3), in mass units/s². They act until they are changed. Can be set."""
        return self._get("force")

    @external_forces.setter
    def external_forces(self, value: npt.ArrayLike) -> None:
        self.set(external_forces=value)

    @property
    def rest_lengths(self) -> FloatArray:
        """Rest lengths of the springs of shape (W, M), in units. That of a muscle oscillates about it. Can be set."""
        return frozen(self._native.rest_lengths())

    @rest_lengths.setter
    def rest_lengths(self, value: npt.ArrayLike) -> None:
        self.set(rest_lengths=value)

    def set(
        self,
        worlds: npt.ArrayLike | None = None,
        *,
        positions: npt.ArrayLike | None = None,
        velocities: npt.ArrayLike | None = None,
        orientations: npt.ArrayLike | None = None,
        angular_momenta: npt.ArrayLike | None = None,
        external_forces: npt.ArrayLike | None = None,
        rest_lengths: npt.ArrayLike | None = None,
    ) -> None:
        """Change states and controls of some worlds.

        Parameters
        ----------
        worlds : array_like of int, shape (K,) or (), or of bool, shape (W,), optional
            The worlds, by number or by a mask; all by default.
        positions, velocities, angular_momenta, external_forces : array_like, shape (K, N, 3) or (N, 3), optional
            States and forces of the spheres, in the units of the attributes of these names.
        orientations : array_like, shape (K, N, 4) or (N, 4), optional
            Unit quaternions w, x, y, z.
        rest_lengths : array_like, shape (K, M) or (M,), optional
            Rest lengths of the springs, in units, not negative.

        Raises
        ------
        ValueError, TypeError
            For a wrong shape, type or value. Nothing is changed then.
        LookupError
            For a world that does not exist. Nothing is changed then.
        """
        numbers = self._numbers(worlds)
        given = {"positions": positions, "velocities": velocities, "orientations": orientations, "angular_momenta": angular_momenta}
        arrays = []
        for name, value in given.items():
            if value is not None:
                field, columns = STATES[name]
                arrays.append((field, self._rows(name, value, numbers, (columns,))))
        if external_forces is not None:
            arrays.append(("force", self._rows("external_forces", external_forces, numbers, (3,))))
        lengths = None if rest_lengths is None else self._rows("rest_lengths", rest_lengths, numbers, ())
        for field, array in arrays:
            self._native.put(field, numbers, array.ravel())
        if lengths is not None:
            self._native.put_rest_lengths(numbers, lengths.ravel())

    @property
    def masses(self) -> FloatArray:
        """Masses of the spheres of shape (W, N), in mass units."""
        return self._get("mass")[:, :, 0]

    @property
    def radii(self) -> FloatArray:
        """Radii of the spheres of shape (W, N), in units."""
        return self._get("radius")[:, :, 0]

    @property
    def centres(self) -> npt.NDArray[np.float64]:
        """Centre of mass of all spheres of each world, float64 of shape (W, 3), in units; 0 for a world without spheres."""
        masses = self.masses.astype(np.float64)
        total = masses.sum(axis=1, keepdims=True)
        moments: npt.NDArray[np.float64] = np.einsum("wn,wni->wi", masses, self.positions, dtype=np.float64)
        return moments / np.where(total > 0, total, 1.0)

    # Conversions

    def _get(self, field: str) -> FloatArray:
        return frozen(self._native.get(field))

    def _numbers(self, worlds: npt.ArrayLike | None) -> IntArray:
        count = len(self)
        if worlds is None:
            return np.arange(count, dtype=np.int64)
        array = np.asarray(worlds)
        if array.dtype.kind == "b":
            if array.shape != (count,):
                raise ValueError(f"worlds: expected a mask of shape ({count},), got {array.shape}")
            return np.flatnonzero(array).astype(np.int64)
        numbers: IntArray = integers("worlds", worlds)
        if (numbers >= count).any():
            raise LookupError(f"worlds: there is no world {int(numbers.max())}, expected numbers below {count}")
        return numbers

    def _rows(self, name: str, value: Any, numbers: IntArray, columns: tuple[int, ...]) -> FloatArray:
        """An array with a row for each of some worlds, of the same size for all, in which rows that do not exist are 0."""
        counts = self.sphere_counts if columns else self.spring_counts
        room = int(counts.max(initial=0))
        array = floats(name, hidden(value, mask_of(counts)[numbers], columns), (room, *columns), len(numbers))
        exists = np.arange(room) < counts[numbers, None]
        if columns == (4,):
            quaternions(name, array[exists])
        if not columns and (array < 0).any():
            raise ValueError(f"{name}: expected numbers that are not negative, got {array.min()}")
        return array

    def _controls(self, name: str, value: Any, columns: tuple[int, ...], rows: int) -> FloatArray:
        """An array of shape (T, W, ...) of which each row is a control of all worlds."""
        everyone = np.arange(len(self), dtype=np.int64)
        array = np.asarray(value)
        if array.ndim not in (2 + len(columns), 3 + len(columns)) or len(array) != rows:
            counts = self.sphere_counts if columns else self.spring_counts
            inner = ", ".join(str(size) for size in (len(self), int(counts.max(initial=0)), *columns))
            raise ValueError(f"{name}: expected shape ({rows}, {inner}), got {array.shape}")
        converted = [self._rows(name, row, everyone, columns) for row in array]
        return np.stack(converted) if converted else np.zeros((0, len(self), 0), np.float32)


def frozen(array: FloatArray) -> FloatArray:
    array.flags.writeable = False
    return array


def mask_of(counts: IntArray) -> npt.NDArray[np.bool_]:
    mask: npt.NDArray[np.bool_] = np.arange(int(counts.max(initial=0))) < counts[:, None]
    return mask


def hidden(value: Any, exists: npt.NDArray[np.bool_], columns: tuple[int, ...]) -> Any:
    """A value with zeros in the rows that do not exist, if it has the right shape and some rows do not exist."""
    if exists.all():
        return value
    array = np.asarray(value)
    if array.dtype.kind not in "fiu" or array.shape not in ((*exists.shape, *columns), (exists.shape[1], *columns)):
        return value
    return np.where(exists.reshape(*exists.shape, *(1 for _ in columns)), array, 0)
