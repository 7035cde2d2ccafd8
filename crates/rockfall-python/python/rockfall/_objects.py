"""What scenes and simulations have in common: their objects and constants."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from rockfall import _rockfall
from rockfall._arrays import IntArray, common, floats, integers, quaternions, rows_of, switches
from rockfall._settings import Settings

#: Names of the kinds of objects.
KINDS = ("sphere", "rod", "capsule", "spring", "tether", "box", "polygon")

_COLUMNS: dict[str, tuple[list[str], list[tuple[str, int]]]] = {
    "sphere": (["id", "fixed", "group"], [("radius", 1), ("mass", 1)]),
    "rod": (["id", "end1", "end2", "group"], [("radius", 1), ("length", 1)]),
    "capsule": (["id", "end1", "end2"], []),
    "spring": (["id", "a", "b"], [("stiffness", 1), ("length", 1), ("damping", 1)]),
    "tether": (["id", "sphere"], [("point", 3), ("stiffness", 1), ("length", 1), ("damping", 1)]),
    "box": (["id", "group"], [("corner", 3), ("i", 3), ("j", 3), ("k", 3)]),
    "polygon": (["id", "group"], [("corner", 3), ("left", 3), ("right", 3)]),
}


class Counts(NamedTuple):
    """Number of objects of each kind. The spheres and rods of capsules count as spheres and rods too."""

    spheres: int
    rods: int
    capsules: int
    springs: int
    tethers: int
    boxes: int
    polygons: int


class Capsules(NamedTuple):
    """Numbers of capsules and their parts, as :meth:`Objects.add_capsules` returns them."""

    #: Numbers of the capsules, of shape (N,).
    capsules: IntArray
    #: Numbers of the spheres at both ends, of shape (N, 2).
    spheres: IntArray
    #: Numbers of the rods, of shape (N,).
    rods: IntArray


def _numbers(first: int, count: int) -> IntArray:
    return np.arange(first, first + count, dtype=np.int64)


class Objects:
    """Objects that can be added, removed and changed. The base of :class:`Scene` and :class:`Simulation`.

    Every ``add`` method takes N objects at once. An argument with one value instead of N counts for all of them. It returns
    the numbers of the new objects as an int64 array of shape (N,). Numbers count from 0 in the order of addition and are never
    used again, so they stay valid when other objects are removed. As long as nothing is removed, the number of a sphere is
    also its row in arrays such as :attr:`Simulation.positions`. If one row is wrong, nothing is added.

    Arrays may have any real or integer dtype; they are copied to float32. They may be read-only, not contiguous, lists, and
    arrays of other libraries in host memory.

    Lengths are in arbitrary units, masses in arbitrary mass units, times in seconds.
    """

    _native: Any

    def _edited(self) -> None:
        """Called before objects are added, removed or changed."""

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

    def add_spheres(
        self,
        position: npt.ArrayLike,
        radius: npt.ArrayLike,
        mass: npt.ArrayLike = 1.0,
        velocity: npt.ArrayLike | None = None,
        *,
        angular_momentum: npt.ArrayLike | None = None,
        orientation: npt.ArrayLike | None = None,
        force: npt.ArrayLike | None = None,
        fixed: npt.ArrayLike = False,
        group: npt.ArrayLike = 0,
    ) -> IntArray:
        """Add solid balls.

        Parameters
        ----------
        position : array_like, shape (N, 3) or (3,)
            Centres, in units.
        radius : array_like, shape (N,) or ()
            Radii in units, greater than 0.
        mass : array_like, shape (N,) or ()
            Masses, greater than 0.
        velocity : array_like, shape (N, 3) or (3,), optional
            Velocities, in units/s; at rest by default.
        angular_momentum : array_like, shape (N, 3) or (3,), optional
            Angular momenta, in mass units²/s.
        orientation : array_like, shape (N, 4) or (4,), optional
            Unit quaternions w, x, y, z.
        force : array_like, shape (N, 3) or (3,), optional
            External forces in mass units/s², which act until they are changed.
        fixed : array_like of bool, shape (N,) or ()
            Whether the spheres never move.
        group : array_like of int, shape (N,) or ()
            Collision groups from 0 to 65535. Objects of different groups never touch.

        Returns
        -------
        ndarray of int64, shape (N,)
            Numbers of the spheres.

        Raises
        ------
        ValueError
            For a wrong shape, a number that is not finite or out of range.
        TypeError
            For an array that does not hold numbers, or that is on a device.
        """
        count = common(
            position=(position, (3,)),
            radius=(radius, ()),
            mass=(mass, ()),
            velocity=(velocity, (3,)),
            angular_momentum=(angular_momentum, (3,)),
            orientation=(orientation, (4,)),
            force=(force, (3,)),
            fixed=(fixed, ()),
            group=(group, ()),
        )

        def vectors(name: str, value: Any) -> Any:
            return floats(name, (0.0, 0.0, 0.0) if value is None else value, (3,), count)

        arguments = (
            floats("position", position, (3,), count),
            floats("radius", radius, (), count, positive=True),
            floats("mass", mass, (), count, positive=True),
            vectors("velocity", velocity),
            vectors("angular_momentum", angular_momentum),
            quaternions("orientation", (1.0, 0.0, 0.0, 0.0) if orientation is None else orientation, count),
            vectors("force", force),
            switches("fixed", fixed, count),
            integers("group", group, count, dtype=np.uint16),
        )
        self._edited()
        return _numbers(_rockfall.add_spheres(self._native, *arguments), count)

    def add_sphere(self, position: npt.ArrayLike, radius: float, mass: float = 1.0, **options: Any) -> int:
        """Add one sphere and return its number. The options are those of :meth:`add_spheres`."""
        _check_single("add_spheres", position=(position, (3,)), radius=(radius, ()), mass=(mass, ()))
        return _single(self.add_spheres(position, radius, mass, **options))

    def add_rods(
        self,
        end1: npt.ArrayLike,
        end2: npt.ArrayLike,
        radius: npt.ArrayLike,
        length: npt.ArrayLike | None = None,
        *,
        group: npt.ArrayLike = 0,
    ) -> IntArray:
        """Add rods (cylinders without caps and mass) between spheres.

        Parameters
        ----------
        end1, end2 : array_like of int, shape (N,) or ()
            Numbers of the spheres at the ends.
        radius : array_like, shape (N,) or ()
            Radii in units, greater than 0.
        length : array_like, shape (N,) or (), optional
            Lengths at which the rods are held, in units. 0, and None, leave a rod free.
        group : array_like of int, shape (N,) or ()
            Collision groups from 0 to 65535.

        Returns
        -------
        ndarray of int64, shape (N,)
            Numbers of the rods.

        Raises
        ------
        ValueError, TypeError
            As for :meth:`add_spheres`, and for a rod from a sphere to itself.
        LookupError
            For a sphere that does not exist.
        """
        count = common(end1=(end1, ()), end2=(end2, ()), radius=(radius, ()), length=(length, ()), group=(group, ()))
        arguments = (
            integers("end1", end1, count),
            integers("end2", end2, count),
            floats("radius", radius, (), count, positive=True),
            floats("length", 0.0 if length is None else length, (), count, not_negative=True),
            integers("group", group, count, dtype=np.uint16),
        )
        self._edited()
        return _numbers(_rockfall.add_rods(self._native, *arguments), count)

    def add_rod(self, end1: int, end2: int, radius: float, length: float | None = None, *, group: int = 0) -> int:
        """Add one rod and return its number; see :meth:`add_rods`."""
        _check_single("add_rods", end1=(end1, ()), end2=(end2, ()), radius=(radius, ()), length=(length, ()))
        return _single(self.add_rods(end1, end2, radius, length, group=group))

    def add_capsules(
        self,
        end1: npt.ArrayLike,
        end2: npt.ArrayLike,
        radius: npt.ArrayLike,
        mass: npt.ArrayLike = 1.0,
        velocity: npt.ArrayLike | None = None,
        *,
        group: npt.ArrayLike = 0,
    ) -> Capsules:
        """Add capsules: rigid bodies of two spheres, each with half the mass, and a rod of fixed length.

        Parameters
        ----------
        end1, end2 : array_like, shape (N, 3) or (3,)
            Centres of the spheres at the ends, in units.
        radius : array_like, shape (N,) or ()
            Radii in units, greater than 0.
        mass : array_like, shape (N,) or ()
            Masses of the whole capsules, greater than 0.
        velocity : array_like, shape (N, 3) or (3,), optional
            Velocities of both ends, in units/s.
        group : array_like of int, shape (N,) or ()
            Collision groups from 0 to 65535.

        Returns
        -------
        Capsules
            Numbers of the capsules, their spheres and their rods.

        Raises
        ------
        ValueError, TypeError
            As for :meth:`add_spheres`, and for ends that coincide.
        """
        count = common(
            end1=(end1, (3,)), end2=(end2, (3,)), radius=(radius, ()), mass=(mass, ()), velocity=(velocity, (3,)), group=(group, ())
        )
        arguments = (
            floats("end1", end1, (3,), count),
            floats("end2", end2, (3,), count),
            floats("radius", radius, (), count, positive=True),
            floats("mass", mass, (), count, positive=True),
            floats("velocity", (0.0, 0.0, 0.0) if velocity is None else velocity, (3,), count),
            integers("group", group, count, dtype=np.uint16),
        )
        self._edited()
        capsules, spheres, rods = _rockfall.add_capsules(self._native, *arguments)
        return Capsules(_numbers(capsules, count), _numbers(spheres, 2 * count).reshape(count, 2), _numbers(rods, count))

    def add_springs(
        self,
        a: npt.ArrayLike,
        b: npt.ArrayLike,
        stiffness: npt.ArrayLike,
        length: npt.ArrayLike | None = None,
        damping: npt.ArrayLike = 0.0,
    ) -> IntArray:
        """Add damped springs between spheres.

        Parameters
        ----------
        a, b : array_like of int, shape (N,) or ()
            Numbers of the spheres.
        stiffness : array_like, shape (N,) or ()
            Stiffness in mass/s², not negative.
        length : array_like, shape (N,) or (), optional
            Rest lengths in units, not negative; by default the distance of the spheres.
        damping : array_like, shape (N,) or ()
            Damping in mass/s, not negative.

        Returns
        -------
        ndarray of int64, shape (N,)
            Numbers of the springs.

        Raises
        ------
        ValueError, TypeError, LookupError
            As for :meth:`add_rods`.
        """
        count = common(a=(a, ()), b=(b, ()), stiffness=(stiffness, ()), length=(length, ()), damping=(damping, ()))
        arguments = (
            integers("a", a, count),
            integers("b", b, count),
            floats("stiffness", stiffness, (), count, not_negative=True),
            floats("length", -1.0, (), count) if length is None else floats("length", length, (), count, not_negative=True),
            floats("damping", damping, (), count, not_negative=True),
        )
        self._edited()
        return _numbers(_rockfall.add_springs(self._native, *arguments), count)

    def add_spring(self, a: int, b: int, stiffness: float, length: float | None = None, damping: float = 0.0) -> int:
        """Add one spring and return its number; see :meth:`add_springs`."""
        _check_single("add_springs", a=(a, ()), b=(b, ()), stiffness=(stiffness, ()), length=(length, ()))
        return _single(self.add_springs(a, b, stiffness, length, damping))

    def add_tethers(
        self,
        sphere: npt.ArrayLike,
        point: npt.ArrayLike,
        stiffness: npt.ArrayLike,
        length: npt.ArrayLike = 0.0,
        damping: npt.ArrayLike = 0.0,
    ) -> IntArray:
        """Add damped springs between spheres and points in space.

        Parameters
        ----------
        sphere : array_like of int, shape (N,) or ()
            Numbers of the spheres.
        point : array_like, shape (N, 3) or (3,)
            Fixed points, in units.
        stiffness, length, damping : array_like, shape (N,) or ()
            Stiffness in mass/s², rest length in units and damping in mass/s, not negative.

        Returns
        -------
        ndarray of int64, shape (N,)
            Numbers of the tethers.

        Raises
        ------
        ValueError, TypeError, LookupError
            As for :meth:`add_rods`.
        """
        count = common(
            sphere=(sphere, ()), point=(point, (3,)), stiffness=(stiffness, ()), length=(length, ()), damping=(damping, ())
        )
        arguments = (
            integers("sphere", sphere, count),
            floats("point", point, (3,), count),
            floats("stiffness", stiffness, (), count, not_negative=True),
            floats("length", length, (), count, not_negative=True),
            floats("damping", damping, (), count, not_negative=True),
        )
        self._edited()
        return _numbers(_rockfall.add_tethers(self._native, *arguments), count)

    def add_boxes(self, corner: npt.ArrayLike, edges: npt.ArrayLike, *, group: npt.ArrayLike = 0) -> IntArray:
        """Add static boxes.

        Parameters
        ----------
        corner : array_like, shape (N, 3) or (3,)
            A corner of each box, in units.
        edges : array_like, shape (N, 3, 3) or (3, 3)
            The three edges from that corner, one per row, at right angles to each other, in units.
        group : array_like of int, shape (N,) or ()
            Collision groups from 0 to 65535.

        Returns
        -------
        ndarray of int64, shape (N,)
            Numbers of the boxes.

        Raises
        ------
        ValueError, TypeError
            As for :meth:`add_spheres`, and for edges that are not at right angles.
        """
        count = common(corner=(corner, (3,)), edges=(edges, (3, 3)), group=(group, ()))
        arguments = (
            floats("corner", corner, (3,), count),
            floats("edges", edges, (3, 3), count).reshape(3 * count, 3),
            integers("group", group, count, dtype=np.uint16),
        )
        self._edited()
        return _numbers(_rockfall.add_boxes(self._native, *arguments), count)

    def add_box(self, min: npt.ArrayLike, max: npt.ArrayLike, *, group: int = 0) -> int:
        """Add a static box with edges along the axes, between two opposite corners of shape (3,), in units."""
        low, high = floats("min", min, (3,)), floats("max", max, (3,))
        if len(low) != 1 or len(high) != 1:
            raise ValueError(f"min, max: expected shape (3,) each, got {low.shape} and {high.shape}; add_boxes takes arrays")
        with np.errstate(over="ignore"):
            size = high[0] - low[0]
        if not (np.abs(size) > 0).all():
            raise ValueError(f"max: expected a corner that differs from min in every coordinate, got {high[0].tolist()}")
        return _single(self.add_boxes(low[0], np.diag(size), group=group))

    def add_polygons(
        self, corner: npt.ArrayLike, left: npt.ArrayLike, right: npt.ArrayLike, *, group: npt.ArrayLike = 0
    ) -> IntArray:
        """Add static parallelograms. Bodies touch them only on the side that left x right points to.

        Parameters
        ----------
        corner : array_like, shape (N, 3) or (3,)
            A corner of each polygon, in units.
        left, right : array_like, shape (N, 3) or (3,)
            The two edges from that corner, in units.
        group : array_like of int, shape (N,) or ()
            Collision groups from 0 to 65535.

        Returns
        -------
        ndarray of int64, shape (N,)
            Numbers of the polygons.

        Raises
        ------
        ValueError, TypeError
            As for :meth:`add_spheres`, and for edges that are parallel.
        """
        count = common(corner=(corner, (3,)), left=(left, (3,)), right=(right, (3,)), group=(group, ()))
        arguments = (
            floats("corner", corner, (3,), count),
            floats("left", left, (3,), count),
            floats("right", right, (3,), count),
            integers("group", group, count, dtype=np.uint16),
        )
        self._edited()
        return _numbers(_rockfall.add_polygons(self._native, *arguments), count)

    def remove(self, kind: str, ids: npt.ArrayLike) -> None:
        """Remove objects.

        A sphere is removed with its rods, capsules, springs and tethers, and a capsule with its spheres and its rod. If a rod
        of a capsule is removed, the two spheres stay. The time grows with the number of removed objects times the number of
        objects of the kind.

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
        self._update("rod", ids, radius=(radius, (), True), length=(length, (), False))

    def update_springs(
        self,
        ids: npt.ArrayLike,
        *,
        stiffness: npt.ArrayLike | None = None,
        length: npt.ArrayLike | None = None,
        damping: npt.ArrayLike | None = None,
    ) -> None:
        """Change constants of springs: stiffness in mass/s², length in units, damping in mass/s."""
        self._update("spring", ids, stiffness=(stiffness, (), False), length=(length, (), False), damping=(damping, (), False))

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
            point=(point, (3,), None),
            stiffness=(stiffness, (), False),
            length=(length, (), False),
            damping=(damping, (), False),
        )

    def _update(self, kind: str, ids: npt.ArrayLike, **fields: tuple[Any, tuple[int, ...], bool | None]) -> None:
        numbers = integers("ids", ids)
        given: list[tuple[str, Any]] = []
        for name, (value, columns, positive) in fields.items():
            if value is not None:
                array = floats(
                    name, value, columns, len(numbers), positive=positive is True, not_negative=positive is False
                )
                given.append((name, array.reshape(-1, 1) if not columns else array))
        self._edited()
        _rockfall.update(self._native, kind, numbers, given)

    def table(self, kind: str) -> npt.NDArray[Any]:
        """All objects of a kind and their parameters.

        Parameters
        ----------
        kind : str
            sphere, rod, capsule, spring, tether, box or polygon.

        Returns
        -------
        ndarray, structured, shape (N,)
            One row per object in order of addition. The field ``id`` is the number of the object. Fields that refer to spheres
            (``end1``, ``a``, ``sphere`` and others) hold rows of arrays such as :attr:`Simulation.positions`.
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


def _single(numbers: IntArray) -> int:
    return int(numbers[0])


def _check_single(several: str, **arguments: tuple[Any, tuple[int, ...]]) -> None:
    """Checks that every argument has one row."""
    for name, (value, columns) in arguments.items():
        rows = None if value is None else rows_of(name, value, columns)
        if rows is not None and rows != 1:
            raise ValueError(f"{name}: expected the values of one object, got {rows} rows; {several} takes several objects")


def _check_kind(kind: str) -> None:
    if kind not in KINDS:
        raise ValueError(f"kind: expected one of {', '.join(KINDS)}, got {kind!r}")
