"""What scenes and simulations have in common: their objects and constants."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from rockfall import _rockfall
from rockfall._arrays import GROUP, MATERIAL, MATRIX, NOT_NEGATIVE, POSITIVE, VECTOR, IntArray, Kind, box_between, integers
from rockfall._attributes import Strict
from rockfall._bodies import first_of
from rockfall._flow import Flows
from rockfall._joints import JointObjects
from rockfall._materials import Materials
from rockfall._names import tag_of
from rockfall._periodic import Periodic
from rockfall._settings import SETTINGS, Settings
from rockfall._static import StaticBodies
from rockfall.typing import KindName, LookName

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from rockfall._options import BoxOptions

#: Names of the kinds of objects.
KINDS = ("sphere", "rod", "capsule", "spring", "tether", "box", "polygon")

_COLUMNS: dict[str, tuple[list[str], list[tuple[str, int]]]] = {
    "sphere": (["id", "fixed", "group", "material"], [("radius", 1), ("mass", 1)]),
    "rod": (["id", "end1", "end2", "group", "material"], [("radius", 1), ("length", 1)]),
    "capsule": (["id", "end1", "end2"], []),
    "spring": (["id", "a", "b"], [("stiffness", 1), ("length", 1), ("damping", 1), ("muscle", 3)]),
    "tether": (["id", "sphere"], [("point", 3), ("stiffness", 1), ("length", 1), ("damping", 1)]),
    "box": (["id", "group", "material"], [("corner", 3), ("i", 3), ("j", 3), ("k", 3)]),
    "polygon": (["id", "triangle", "surface", "group", "material"], [("corner", 3), ("left", 3), ("right", 3)]),
}


class Counts(NamedTuple):
    """Number of objects of each kind. The spheres and rods of capsules and rigid bodies count as spheres and rods too."""

    spheres: int
    rods: int
    capsules: int
    springs: int
    tethers: int
    boxes: int
    polygons: int
    bodies: int = 0
    hulls: int = 0
    joints: int = 0


class Objects(StaticBodies, Flows, Periodic, JointObjects, Strict):
    """Objects that can be added, removed and changed. The base of :class:`Scene` and :class:`Simulation`.

    Every ``add`` method takes N objects at once. An argument with one value instead of N counts for all of them. It returns
    the numbers of the new objects as an int64 array of shape (N,). Numbers count from 0 in the order of addition and are never
    used again, so they stay valid when other objects are removed. As long as nothing is removed, the number of a sphere is
    also its row in arrays such as :attr:`Simulation.positions`. If one row is wrong, nothing is added.

    Arrays may have any real or integer dtype; they are copied to float32. They may be read-only, not contiguous, lists, and
    arrays of other libraries in host memory.

    Lengths are in arbitrary units, masses in arbitrary mass units, times in seconds.
    """

    def _further_names(self) -> Iterable[str]:
        return [f"settings.{name}" for name in SETTINGS]

    @property
    def settings(self) -> Settings:
        """The physical constants, as attributes: ``settings.gravity = 9.81``."""
        return Settings(self._native)

    @settings.setter
    def settings(self, value: Any) -> None:
        self._edited()
        for name, number in value.items():
            self.settings[name] = number

    @property
    def counts(self) -> Counts:
        """Number of objects of each kind."""
        return Counts(*_rockfall.counts(self._native))

    def add_boxes(
        self, corner: npt.ArrayLike, edges: npt.ArrayLike, *, group: npt.ArrayLike = 0, material: Materials = None,
        motion: str | None = None, surface_velocity: npt.ArrayLike | None = None, name: str | None = None,
        colour: str | None = None, label: str | None = None, look: LookName | None = None,
    ) -> IntArray:
        """Add boxes, which do not move unless they follow a motion.

        Parameters
        ----------
        corner : array_like, shape (N, 3) or (3,)
            A corner of each box, in units.
        edges : array_like, shape (N, 3, 3) or (3, 3)
            The three edges from that corner, one per row, at right angles to each other, in units.
        group : array_like of int, shape (N,) or ()
            Collision groups from 0 to 65535.
        material : int, str or array_like of them, shape (N,) or (), optional
            Materials, by number or by name; none by default. See :meth:`add_material`.
        motion : str, optional
            Name of the motion that they follow; none by default. See :meth:`add_motion`.
        surface_velocity : array_like of shape (3,), optional
            Velocity of their surfaces, like that of conveyors, in units/s. See :meth:`set_surface_velocity`.
        name, colour, label, look : str, optional
            Name, colour, label and look of the objects. See :meth:`set_tag`.

        Returns
        -------
        ndarray of int64, shape (N,)
            Numbers of the boxes.

        Raises
        ------
        ValueError, TypeError
            As for :meth:`add_spheres`, and for edges that are not at right angles.
        """
        self._check_motion(motion)
        numbers = self._add_kind(
            tag_of(name, colour, label, look),
            _rockfall.add_boxes,
            corner=(corner, VECTOR),
            edges=(edges, MATRIX),
            group=(group, GROUP),
            material=(self._material_numbers("material", material), MATERIAL),
        )
        return self._following("box", numbers, motion, surface_velocity)

    def add_box(self, min: npt.ArrayLike, max: npt.ArrayLike, **options: Unpack[BoxOptions]) -> int:
        """Add a static box with edges along the axes, between two opposite corners of shape (3,), in units.

        The options are those of :meth:`add_boxes`.
        """
        corner, edges = box_between(min, max, "; add_boxes takes arrays")
        return first_of(self.add_boxes(corner, edges, **options))

    def add_polygons(
        self,
        corner: npt.ArrayLike,
        left: npt.ArrayLike,
        right: npt.ArrayLike,
        *,
        group: npt.ArrayLike = 0,
        material: Materials = None,
        motion: str | None = None,
        surface_velocity: npt.ArrayLike | None = None,
        name: str | None = None,
        colour: str | None = None,
        label: str | None = None,
        look: LookName | None = None,
    ) -> IntArray:
        """Add parallelograms, which do not move unless they follow a motion. Bodies touch them only on the side that left x right
        points to.

        Parameters
        ----------
        corner : array_like, shape (N, 3) or (3,)
            A corner of each polygon, in units.
        left, right : array_like, shape (N, 3) or (3,)
            The two edges from that corner, in units.
        group : array_like of int, shape (N,) or ()
            Collision groups from 0 to 65535.
        material : int, str or array_like of them, shape (N,) or (), optional
            Materials, by number or by name; none by default. See :meth:`add_material`.
        motion : str, optional
            Name of the motion that they follow; none by default. See :meth:`add_motion`.
        surface_velocity : array_like of shape (3,), optional
            Velocity of their surfaces, like that of conveyors, in units/s. See :meth:`set_surface_velocity`.
        name, colour, label, look : str, optional
            Name, colour, label and look of the objects. See :meth:`set_tag`.

        Returns
        -------
        ndarray of int64, shape (N,)
            Numbers of the polygons.

        Raises
        ------
        ValueError, TypeError
            As for :meth:`add_spheres`, and for edges that are parallel.
        """
        self._check_motion(motion)
        numbers = self._add_kind(
            tag_of(name, colour, label, look),
            _rockfall.add_polygons,
            corner=(corner, VECTOR),
            left=(left, VECTOR),
            right=(right, VECTOR),
            group=(group, GROUP),
            material=(self._material_numbers("material", material), MATERIAL),
        )
        return self._following("polygon", numbers, motion, surface_velocity)

    def remove(self, kind: KindName, ids: npt.ArrayLike) -> None:
        """Remove objects.

        A sphere is removed with its rods, capsules, springs and tethers, and a capsule with its spheres and its rod. If a rod
        of a capsule is removed, the two spheres stay. A call for many objects takes about as long as a call for one.

        Parameters
        ----------
        kind : str
            sphere, rod, capsule, spring, tether, box or polygon.
        ids : array_like of int, shape (N,) or ()
            Numbers of the objects, as ``add`` methods returned them.

        Raises
        ------
        ValueError
            For an unknown kind.
        LookupError
            For an object that does not exist. Nothing is removed then.
        """
        _check_kind(kind)
        numbers = np.unique(integers("ids", ids))
        self._edited()
        _rockfall.remove(self._native, kind, numbers)

    def update_rods(self, ids: npt.ArrayLike, *, radius: npt.ArrayLike | None = None, length: npt.ArrayLike | None = None) -> None:
        """Change radii and lengths of rods, in units. A length of 0 leaves a rod free."""
        self._update("rod", ids, radius=(radius, POSITIVE), length=(length, NOT_NEGATIVE))

    def update_springs(
        self,
        ids: npt.ArrayLike,
        *,
        stiffness: npt.ArrayLike | None = None,
        length: npt.ArrayLike | None = None,
        damping: npt.ArrayLike | None = None,
        muscle: npt.ArrayLike | None = None,
    ) -> None:
        """Change constants of springs: stiffness in mass/s², length in units, damping in mass/s.

        ``muscle`` is as for :meth:`add_springs`; a row of zeros removes a muscle. Another frequency changes the phase at once,
        because the phase follows from the frequency and the time since the start.
        """
        self._update(
            "spring",
            ids,
            stiffness=(stiffness, NOT_NEGATIVE),
            length=(length, NOT_NEGATIVE),
            damping=(damping, NOT_NEGATIVE),
            muscle=(muscle, VECTOR),
        )

    def update_tethers(
        self,
        ids: npt.ArrayLike,
        *,
        point: npt.ArrayLike | None = None,
        stiffness: npt.ArrayLike | None = None,
        length: npt.ArrayLike | None = None,
        damping: npt.ArrayLike | None = None,
    ) -> None:
        """Change points and constants of tethers, for example to drag bodies. Units as for :meth:`add_tethers`."""
        self._update(
            "tether",
            ids,
            point=(point, VECTOR),
            stiffness=(stiffness, NOT_NEGATIVE),
            length=(length, NOT_NEGATIVE),
            damping=(damping, NOT_NEGATIVE),
        )

    def _update(self, kind: KindName, ids: npt.ArrayLike, **fields: tuple[Any, Kind]) -> None:
        numbers = integers("ids", ids)
        given: list[tuple[str, Any]] = []
        for name, (value, rows) in fields.items():
            if value is not None:
                array = rows.convert(name, value, len(numbers))
                given.append((name, array if rows.columns else array.reshape(-1, 1)))
        self._edited()
        _rockfall.update(self._native, kind, numbers, given)

    def table(self, kind: KindName) -> npt.NDArray[Any]:
        """All objects of a kind and their parameters.

        Parameters
        ----------
        kind : str
            sphere, rod, capsule, spring, tether, box or polygon.

        Returns
        -------
        ndarray, structured, shape (N,)
            One row per object in order of addition. The field ``id`` is the number of the object. Fields that refer to spheres
            (``end1``, ``a``, ``sphere`` and others) hold rows of arrays such as :attr:`Simulation.positions`. ``material`` is -1 for
            none.
        """
        _check_kind(kind)
        whole, real = _rockfall.table(self._native, kind)
        names, columns = _COLUMNS[kind]
        dtype = [(name, np.int64) for name in names]
        dtype += [(name, np.float32) if width == 1 else (name, np.float32, (width,)) for name, width in columns]  # type: ignore[misc]
        table = np.empty(len(whole), dtype=dtype)
        for place, name in enumerate(names):
            table[name] = whole[:, place]
        place = 0
        for name, width in columns:
            table[name] = real[:, place] if width == 1 else real[:, place : place + width]
            place += width
        return table


def _check_kind(kind: str) -> None:
    if kind not in KINDS:
        raise ValueError(f"kind: expected one of {', '.join(KINDS)}, got {kind!r}")
