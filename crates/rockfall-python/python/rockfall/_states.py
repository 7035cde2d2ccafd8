"""The states of spheres as arrays."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
import numpy.typing as npt

from rockfall import _rockfall
from rockfall._arrays import FloatArray, IntArray, floats, integers, quaternions
from rockfall._device import DeviceArray, is_on_cuda
from rockfall._objects import Objects
from rockfall._reports import State

#: Columns of the fields of spheres that can be set.
_FIELDS = {"position": 3, "velocity": 3, "orientation": 4, "angular_momentum": 3, "force": 3}


class States(Objects):
    """Spheres with states that change. A base of :class:`Simulation`."""

    _native: Any
    #: Arrays that were handed out and may be written to, by field.
    _live: dict[str, FloatArray]

    def _field(self, field: str) -> FloatArray:
        if self._native.rank() is not None:
            return self._constant(field)
        array = self._live.get(field)
        if array is None:
            shared = self._native.shared(field)
            # A DeviceArray does what an array does.
            array = self._native.get(field) if shared is None else cast(FloatArray, DeviceArray(shared))
            self._live[field] = array
        return array

    def _set_field(self, field: str, value: Any) -> None:
        if is_on_cuda(value) and value is not self._live.get(field) and self._put_shared(field, value):
            return
        if self._native.rank() is not None:
            raise ValueError(f"{field}: processes share the simulation, and cannot change it (comm)")
        array = self._field(field)
        if value is not array:
            columns = _FIELDS[field]
            array[:] = quaternions(field, value, len(array)) if columns == 4 else floats(field, value, (3,), len(array))
        self._commit()

    def _put_shared(self, field: str, value: Any) -> bool:
        """Sets a field from an array on the device, unless it is another device than that of the simulation."""
        if getattr(value, "requires_grad", False):
            raise TypeError(f"{field}: expected an array without a gradient; call .detach() first")
        self._commit()
        try:
            return bool(self._native.put_shared(field, value))
        except (TypeError, ValueError, BufferError) as error:
            raise type(error)(f"{field}: {error}") from None

    def _commit(self) -> None:
        """Applies what was written to arrays, and makes them snapshots."""
        if not self._live:
            return
        taken, self._live = self._live, {}
        live: dict[str, FloatArray] = {}
        for field, array in taken.items():
            if isinstance(array, DeviceArray):
                changed = array._changed()
                array._freeze()
                if changed:
                    live[field] = array._on_host()
            else:
                array.flags.writeable = False
                live[field] = array
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
    def centres(self) -> npt.NDArray[np.float64]:
        """Centres of shape (N, 3) as float64, in units: with ``precision = "double"``, with all their digits.

        Can be set. The array itself is a read-only copy.
        """
        self._commit()
        array: npt.NDArray[np.float64] = self._native.centres().reshape(-1, 3)
        array.flags.writeable = False
        return array

    @centres.setter
    def centres(self, value: npt.ArrayLike) -> None:
        self._commit()
        try:
            rows = np.broadcast_to(np.asarray(value, dtype=np.float64), (len(self._native.get("radius")), 3))
        except (TypeError, ValueError) as error:
            raise ValueError(f"centres: expected numbers of shape (N, 3): {error}") from None
        if not np.isfinite(rows.astype(np.float32)).all():
            raise ValueError("centres: expected finite numbers")
        self._native.put_centres(np.ascontiguousarray(rows).reshape(-1))

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
        array: npt.NDArray[np.bool_] = self._native.get("fixed") != 0
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
