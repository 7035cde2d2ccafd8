"""Joints and rigid bodies of many worlds as arrays."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from rockfall import _rockfall
from rockfall._arrays import FloatArray, IntArray, floats, integers, quaternions
from rockfall._joints import JointReadings
from rockfall._rigid import BodyFields
from rockfall._world_states import WorldStates, frozen, hidden, mask_of

#: Fields of bodies in a row of numbers.
_COLUMNS = {"position": 0, "orientation": 3, "velocity": 7, "angular_momentum": 10, "spin": 13,
            "force": 16, "torque": 19}  # fmt: skip
#: Fields of bodies that are set, by argument, with their columns.
_BODY = {"positions": ("position", 3), "orientations": ("orientation", 4), "velocities": ("velocity", 3),
         "angular_momenta": ("angular_momentum", 3), "spins": ("spin", 3), "forces": ("force", 3),
         "torques": ("torque", 3)}  # fmt: skip


class WorldJoints(JointReadings):
    """What all joints of all worlds do at present, as :attr:`Worlds.joints` returns them. Each attribute is a new array.

    W is the number of worlds and N the largest number of joints in a world. Joints are in order of addition. Rows of joints
    that do not exist are 0. Shapes are (W, N) where those of :attr:`Simulation.joints` are (N,), and (W, N, 3) where they are
    (N, 3).
    """

    def __init__(self, native: Any) -> None:
        self._native = native
        self._rows, self._broken, self._counts = _rockfall.world_joints(native)

    @property
    def mask(self) -> npt.NDArray[np.bool_]:
        """Which joints exist, of shape (W, N)."""
        return mask_of(self._counts)

    @property
    def names(self) -> list[list[str | None]]:
        """Names of the joints of each world; None for a joint without one."""
        return _rockfall.world_joint_names(self._native)


class WorldBodies(BodyFields):
    """States of all rigid bodies of all worlds, as :attr:`Worlds.bodies` returns them. Each attribute is a new array.

    W is the number of worlds and N the largest number of rigid bodies in a world. Bodies are in order of addition. Rows of
    bodies that do not exist are 0. Shapes are (W, N, 3), and (W, N, 4) for orientations.
    """

    def __init__(self, native: Any) -> None:
        self._rows, self._counts = _rockfall.world_bodies(native)

    def __len__(self) -> int:
        return int(self._rows.shape[1])

    def _field(self, field: str, width: int = 3) -> FloatArray:
        first = _COLUMNS[field]
        return frozen(self._rows[..., first : first + width].copy())

    @property
    def mask(self) -> npt.NDArray[np.bool_]:
        """Which bodies exist, of shape (W, N)."""
        return mask_of(self._counts)

    @property
    def spins(self) -> FloatArray:
        """Angular velocities along the axes of the world, of shape (W, N, 3), in rad/s."""
        return self._field("spin")


class WorldMechanisms(WorldStates):
    """Worlds with joints and rigid bodies. A base of :class:`Worlds`."""

    @property
    def joints(self) -> WorldJoints:
        """What all joints do at present: ``positions``, ``speeds``, ``forces``, ``torques``, ``errors`` and ``broken``."""
        return WorldJoints(self._native)

    @property
    def bodies(self) -> WorldBodies:
        """States of all rigid bodies.

        ``positions``, ``orientations``, ``velocities``, ``angular_momenta`` and ``spins``, and the external ``forces`` and ``torques``.
        """
        return WorldBodies(self._native)

    def set_joints(
        self, worlds: npt.ArrayLike | None = None, joints: npt.ArrayLike | None = None, **numbers: npt.ArrayLike
    ) -> None:
        """Set numbers of joints, from the next step on, until :meth:`reset`. A controller may do it in every step.

        Parameters
        ----------
        worlds : array_like of int, shape (K,) or (), or of bool, shape (W,), optional
            The worlds, by number or by a mask; all by default.
        joints : array_like of int, shape (J,) or (), optional
            Joints, counted in order of addition in each world; by default all. Each of the worlds must have them.
        **numbers : array_like, shape (K, J), (J,) or ()
            ``speed`` (nan for no motor), ``max_force``, ``target`` (nan for that of the start) and the others of
            :meth:`Objects.set_joints`, with its units.

        Raises
        ------
        LookupError
            For a world that does not exist. Nothing is changed then.
        ValueError, TypeError
            For another name or shape, a joint that does not exist, and numbers out of their range. Joints before a wrong one
            are set.
        """
        chosen, places = self._numbers(worlds), self._places("joints", joints, 2)
        shape = (len(chosen), len(places))
        fields = []
        for field, value in numbers.items():
            array = np.asarray(value, dtype=np.float32)
            if array.shape not in (shape, shape[1:], ()):
                raise ValueError(f"{field}: expected shape {shape}, ({shape[1]},) or (), got {array.shape}")
            fields.append((field, np.ascontiguousarray(np.broadcast_to(array, shape))))
        _rockfall.set_world_joints(self._native, chosen, places, fields)

    def set_joint_forces(
        self,
        forces: npt.ArrayLike,
        worlds: npt.ArrayLike | None = None,
        *,
        joints: npt.ArrayLike | None = None,
        fastest: npt.ArrayLike | None = None,
    ) -> None:
        """Exert torques on the axes of hinges and forces on those of sliders, until they are changed.

        A force is the ``effort`` of :meth:`set_joints`. With ``fastest``, a motor seeks that speed in the direction of the force,
        and its greatest force is the size of it: ``speed`` and ``max_force`` of :meth:`set_joints`. A joint that turns faster is
        braked, and ``max_force`` also bounds springs and their dampers.

        Parameters
        ----------
        forces : array_like, shape (K, J), (J,) or ()
            Torques in mass units²/s², or forces in mass units/s², on the second bodies of the joints.
        worlds, joints
            As for :meth:`set_joints`.
        fastest : array_like, shape (K, J), (J,) or ()
            Speed up to which motors push, in rad/s or units/s, not negative. By default there is no such speed.

        Raises
        ------
        LookupError, ValueError, TypeError
            As for :meth:`set_joints`.
        """
        given = np.asarray(forces, dtype=np.float32)
        if fastest is None:
            self.set_joints(worlds, joints, effort=given, speed=np.nan)
            return
        speed = np.sign(given) * np.asarray(fastest, np.float32)
        self.set_joints(worlds, joints, speed=speed, max_force=np.abs(given), effort=0.0)

    def place_joints(
        self, positions: npt.ArrayLike, speeds: npt.ArrayLike = 0.0, worlds: npt.ArrayLike | None = None
    ) -> None:
        """Move bodies so that joints have these positions and speeds.

        Bodies that joints connect to the world are placed from there. Otherwise the first body of the first joint stays as it
        is, and what is connected to it follows. A ball has the position as its twist and no swing. Numbers of fixed joints
        and of distance joints are ignored.

        Parameters
        ----------
        positions : array_like, shape (K, N), (N,) or ()
            Positions of all joints, in rad or units. N is the largest number of joints in a world.
        speeds : array_like, shape (K, N), (N,) or ()
            Rates of the positions, in rad/s or units/s.
        worlds : array_like of int, shape (K,) or (), or of bool, shape (W,), optional
            The worlds, by number or by a mask; all by default.

        Raises
        ------
        LookupError
            For a world that does not exist. Nothing is changed then.
        ValueError, TypeError
            For a wrong shape, type or value. Nothing is changed then.
        """
        chosen, exists = self._numbers(worlds), mask_of(self._native.counts()[2])
        shape = (len(chosen), exists.shape[1])
        rows = []
        for name, value in (("positions", positions), ("speeds", speeds)):
            full = np.broadcast_to(np.asarray(value), shape) if np.ndim(value) == 0 else value
            rows.append(floats(name, hidden(full, exists[chosen], ()), shape[1:], len(chosen)))
        _rockfall.place_world_joints(self._native, chosen, *rows)

    def set_bodies(
        self,
        worlds: npt.ArrayLike | None = None,
        bodies: npt.ArrayLike | None = None,
        *,
        positions: npt.ArrayLike | None = None,
        orientations: npt.ArrayLike | None = None,
        velocities: npt.ArrayLike | None = None,
        angular_momenta: npt.ArrayLike | None = None,
        spins: npt.ArrayLike | None = None,
        forces: npt.ArrayLike | None = None,
        torques: npt.ArrayLike | None = None,
    ) -> None:
        """Set the states of rigid bodies, and the forces on them.

        What is not given stays. A change of the forces and torques alone is cheap. Joints that this pulls apart draw together in the next steps.

        Parameters
        ----------
        worlds : array_like of int, shape (K,) or (), or of bool, shape (W,), optional
            The worlds, by number or by a mask; all by default.
        bodies : array_like of int, shape (B,) or (), optional
            Bodies, counted in order of addition in each world; by default all. Each of the worlds must have them.
        positions, velocities, angular_momenta, spins : array_like, shape (K, B, 3) or (B, 3), optional
            Centres of mass in units, their velocities in units/s, and angular momenta about them in mass units²/s or angular
            velocities in rad/s, along the axes of the world.
        orientations : array_like, shape (K, B, 4) or (B, 4), optional
            Unit quaternions w, x, y, z.
        forces, torques : array_like, shape (K, B, 3) or (B, 3), optional
            External forces at the centres of mass in mass units/s², and external torques about them in mass units²/s², along the
            axes of the world. They act until they are changed.

        Raises
        ------
        LookupError
            For a world that does not exist. Nothing is changed then.
        ValueError, TypeError
            For a wrong shape, type or value, and a body that does not exist. Bodies before one that does not exist are set.
        """
        if angular_momenta is not None and spins is not None:
            raise TypeError("angular_momenta, spins: expected at most one of them")
        chosen = self._numbers(worlds)
        places = self._places("bodies", bodies, 3)
        given = {"positions": positions, "orientations": orientations, "velocities": velocities,
                 "angular_momenta": angular_momenta, "spins": spins, "forces": forces, "torques": torques}  # fmt: skip
        fields = []
        for name, value in given.items():
            if value is None:
                continue
            field, width = _BODY[name]
            array = floats(name, value, (len(places), width), len(chosen))
            if width == 4:
                quaternions(name, array.reshape(-1, 4))
            fields.append((field, array))
        _rockfall.set_world_bodies(self._native, chosen, places, fields)

    def _places(self, name: str, given: npt.ArrayLike | None, count: int) -> IntArray:
        """Places in the list of joints or bodies; all by default. `count` is the place of their numbers in those of worlds."""
        if given is None:
            return np.arange(self._native.counts()[count].max(initial=0), dtype=np.int64)
        places: IntArray = integers(name, given)
        return places
