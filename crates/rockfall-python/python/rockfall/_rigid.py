"""Shapes and rigid bodies."""

from __future__ import annotations

from typing import Any, NamedTuple, cast

import numpy as np
import numpy.typing as npt

from rockfall import _rockfall
from rockfall._arrays import QUATERNION, VECTOR, FloatArray, IntArray, box_between, columns, floats, integers, whole
from rockfall._bodies import Bodies, first_of, numbers_from
from rockfall._device import DeviceArray
from rockfall._materials import Materials
from rockfall._names import tag_of
from rockfall.typing import LookName

_ZERO = (0.0, 0.0, 0.0)
_UPRIGHT = (1.0, 0.0, 0.0, 0.0)


class Shape:
    """What rigid bodies are made of: spheres, rods between them, boxes, and convex hulls, in coordinates of the shape.

    Parts may overlap. The matter fills them evenly, and counts once where parts overlap. Each method returns the shape, so that
    calls can follow each other: ``rf.Shape(density=2).sphere([0, 0, 0], 0.5).sphere([0.7, 0, 0], 0.4)``.

    Parameters
    ----------
    mass : float, optional
        Mass of a body, greater than 0; 1 if neither mass nor density is given.
    density : float, optional
        Density in mass/units³, greater than 0. Not with `mass`.
    centre, inertia : array_like, shape (3,) and (6,), optional
        Centre of mass in units, and inertia xx, yy, zz, xy, xz, yz about it in mass units². Both or none; by default they follow from
        the parts.
    rounding : float, optional
        Rounding radius of all boxes in units, less than half the shortest edge. It is kept in files and has no effect:
        edges are sharp.
    name : str, optional
        Name, which no other shape of the scene has.

    Raises
    ------
    ValueError, TypeError
        For numbers that are not finite, a negative rounding, and for mass with density, density with inertia, and centre without
        inertia. Other wrong values are errors of :meth:`Objects.add_shape`.
    """

    def __init__(
        self,
        *,
        mass: float | None = None,
        density: float | None = None,
        centre: npt.ArrayLike | None = None,
        inertia: npt.ArrayLike | None = None,
        rounding: float | None = None,
        name: str | None = None,
    ) -> None:
        if density is not None and (mass is not None or inertia is not None):
            raise ValueError("density: expected without mass and inertia")
        if (centre is None) != (inertia is None):
            raise ValueError("centre, inertia: expected both or none of them")
        given: tuple[list[float], list[float]] | None = None
        if centre is not None and inertia is not None:
            given = (_row("centre", centre, (3,)), _row("inertia", inertia, (6,)))
        self._mass = (_number("mass", mass), _number("density", density), given)
        self._rounding = 0.0 if rounding is None else float(_row("rounding", rounding, not_negative=True))
        self._name = name
        self._spheres: list[tuple[list[float], float, int, Any]] = []
        self._rods: list[tuple[int, int, float, int, Any]] = []
        self._boxes: list[tuple[list[float], list[list[float]], int, Any]] = []
        self._hulls: list[tuple[list[list[float]], int, Any]] = []

    def sphere(self, centre: npt.ArrayLike, radius: float, *, group: int = 0, material: Materials = None) -> Shape:
        """Add a sphere. Centre and radius are in units."""
        self._spheres.append((_row("centre", centre, (3,)), _row("radius", radius), _group(group), material))
        return self

    def rod(self, a: int, b: int, radius: float, *, group: int = 0, material: Materials = None) -> Shape:
        """Add a rod between the spheres number `a` and `b` of the shape, from 0. The radius is in units."""
        self._rods.append((_whole("a", a), _whole("b", b), _row("radius", radius), _group(group), material))
        return self

    def capsule(
        self, end1: npt.ArrayLike, end2: npt.ArrayLike, radius: float, *, group: int = 0, material: Materials = None
    ) -> Shape:
        """Add a capsule: two spheres and a rod. Ends and radius are in units."""
        first = len(self._spheres)
        self.sphere(end1, radius, group=group, material=material).sphere(end2, radius, group=group, material=material)
        return self.rod(first, first + 1, radius, group=group, material=material)

    def box(self, min: npt.ArrayLike, max: npt.ArrayLike, *, group: int = 0, material: Materials = None) -> Shape:
        """Add a box with edges along the axes of the shape, between two opposite corners of shape (3,), in units.

        See :meth:`cuboid` for boxes that are turned, and for the sphere of a box.
        """
        return self.cuboid(*box_between(min, max), group=group, material=material)

    def cuboid(self, corner: npt.ArrayLike, edges: npt.ArrayLike, *, group: int = 0, material: Materials = None) -> Shape:
        """Add a box with edges in any direction.

        A body has a sphere for each box, after the spheres of the shape: the one around the whole box. Only the contact
        law ``rigid`` takes bodies with boxes.

        Parameters
        ----------
        corner : array_like, shape (3,)
            A corner of the box, in units.
        edges : array_like, shape (3, 3)
            The three edges from that corner, one per row, at right angles to each other, in units.
        group : int, optional
            Collision group from 0 to 65535.
        material : int or str, optional
            Material, by number or by name; none by default.
        """
        self._boxes.append((_row("corner", corner, (3,)), _row("edges", edges, (3, 3)), _group(group), material))
        return self

    def add_hull(self, points: npt.ArrayLike, *, group: int = 0, material: Materials = None) -> Shape:
        """Add the convex hull of points. Only the contact law ``rigid`` takes shapes with hulls.

        A body has one sphere for each hull, after all others: the sphere about the centre of its volume that contains it. Edges and corners
        are sharp; the rounding of the shape has no effect on them.

        Parameters
        ----------
        points : array_like, shape (N, 3)
            From 4 to 100,000 points, in units. Their hull has at most 32 faces; points that are none of its vertices are left out.
        group : int, optional
            Collision group from 0 to 65535.
        material : int or str, optional
            Material, by number or by name; none by default.
        """
        self._hulls.append((floats("points", points, (3,)).tolist(), _group(group), material))
        return self


def shape_number(shape: Any) -> int:
    """Returns the number of a shape."""
    if isinstance(shape, Shape):
        raise TypeError("shape: expected the number that add_shape returns, got a Shape: call add_shape first")
    return whole("shape", shape)


def _row(name: str, value: Any, shape: tuple[int, ...] = (), *, not_negative: bool = False) -> Any:
    """Returns a number, or nested lists of numbers of this shape."""
    rows = floats(name, value, shape, not_negative=not_negative)
    if len(rows) != 1:
        raise ValueError(f"{name}: expected {f'shape {shape}' if shape else 'one number'}, got shape {np.shape(value)}")
    return rows[0].tolist()


def _whole(name: str, value: int, dtype: Any = np.int64) -> int:
    numbers = integers(name, value, dtype=dtype)
    if len(numbers) != 1:
        raise ValueError(f"{name}: expected one number, got shape {np.shape(value)}")
    return int(numbers[0])


def _group(value: int) -> int:
    return _whole("group", value, np.uint16)


def _number(name: str, value: float | None) -> float | None:
    return None if value is None else float(_row(name, value))


class MassProperties(NamedTuple):
    """Mass properties of a shape, as :meth:`Objects.shape_mass` returns them."""

    #: Mass.
    mass: float
    #: Centre of mass in coordinates of the shape, in units.
    centre: tuple[float, float, float]
    #: Inertia xx, yy, zz, xy, xz, yz about the centre along the axes of the shape, in mass units².
    inertia: tuple[float, float, float, float, float, float]


class RigidBodies(NamedTuple):
    """Numbers of rigid bodies and their parts, as :meth:`Objects.add_bodies` returns them."""

    #: Numbers of the bodies, of shape (N,).
    bodies: IntArray
    #: Numbers of the spheres of each body, of shape (N, spheres of the shape + 9 for each box).
    spheres: IntArray
    #: Numbers of the rods of each body, of shape (N, rods of the shape + 12 for each box).
    rods: IntArray


class BodyFields:
    """States of rigid bodies.

    N is their number. Bodies of worlds have rows for W worlds before that: (W, N, 3) in place of (N, 3).
    """

    def __len__(self) -> int:
        return int(self.positions.shape[-2])

    def _field(self, field: str, width: int = 3) -> FloatArray:
        raise NotImplementedError

    @property
    def positions(self) -> FloatArray:
        """Centres of mass of shape (N, 3), in units."""
        return self._field("position")

    @property
    def orientations(self) -> FloatArray:
        """Unit quaternions w, x, y, z of shape (N, 4), which turn coordinates of the shape into those of the world."""
        return self._field("orientation", 4)

    @property
    def velocities(self) -> FloatArray:
        """Velocities of the centres of mass of shape (N, 3), in units/s."""
        return self._field("velocity")

    @property
    def angular_momenta(self) -> FloatArray:
        """Angular momenta about the centres of mass along the axes of the world, of shape (N, 3), in mass units²/s."""
        return self._field("angular_momentum")

    @property
    def forces(self) -> FloatArray:
        """External forces at the centres of mass of shape (N, 3), in mass units/s², as :meth:`Objects.set_bodies` sets them."""
        return self._field("force")

    @property
    def torques(self) -> FloatArray:
        """External torques about the centres of mass along the axes of the world, of shape (N, 3), in mass units²/s²."""
        return self._field("torque")


class BodyStates(BodyFields):
    """States of all rigid bodies in order of addition, as :attr:`Objects.bodies` returns them. Each attribute is a new array.

    In a simulation on an NVIDIA card the arrays are on the device, and PyTorch and others take them by DLPack without a copy
    through the host, as those of :attr:`Simulation.positions`. They cannot be written to.
    """

    def __init__(self, objects: Rigid) -> None:
        self._objects = objects

    def _field(self, field: str, width: int = 3) -> FloatArray:
        self._objects._edited()
        shared_bodies = getattr(self._objects._native, "shared_bodies", None)
        # External forces are kept on the host.
        shared = shared_bodies(field) if shared_bodies and field not in ("force", "torque") else None
        if shared is not None:
            # A DeviceArray does what an array does.
            on_device = DeviceArray(shared)
            on_device._freeze()
            return cast(FloatArray, on_device)
        array: FloatArray = _rockfall.body_states(self._objects._native, field).reshape(-1, width)
        # A copy, in which a change would be lost.
        array.flags.writeable = False
        return array


class Rigid(Bodies):
    """Adds rigid bodies. A base of :class:`Objects`."""

    def add_shape(self, shape: Shape) -> int:
        """Add a shape and return its number.

        Raises
        ------
        ValueError
            For a shape without spheres and boxes or with more than 1000 parts, a mass, density or radius that is not positive, a rod
            without two different spheres, a box whose edges are not at right angles, a rounding that is not less than half the shortest
            edge, points in one plane, a hull with more than 32 faces, an inertia that no body has, and a name that another shape has.
        LookupError
            For a material that does not exist.
        """
        if not isinstance(shape, Shape):
            raise TypeError(f"shape: expected a rockfall.Shape, got {type(shape).__name__}")
        material = self._single_material
        spheres = [(*sphere[:3], material(sphere[3])) for sphere in shape._spheres]
        rods = [(*rod[:4], material(rod[4])) for rod in shape._rods]
        boxes = [(*box[:3], material(box[3])) for box in shape._boxes]
        hulls = [(*hull[:2], material(hull[2])) for hull in shape._hulls]
        self._edited()
        return int(_rockfall.add_shape(self._native, shape._name, shape._mass, spheres, rods, boxes, hulls, shape._rounding))

    def _single_material(self, material: Materials) -> int:
        return int(np.atleast_1d(self._material_numbers("material", material))[0])

    def shape_mass(self, shape: int) -> MassProperties:
        """Mass, centre and inertia of a shape, by its number."""
        self._edited()
        return MassProperties(*_rockfall.shape_mass(self._native, shape_number(shape)))

    def add_bodies(
        self,
        shape: int,
        positions: npt.ArrayLike,
        orientations: npt.ArrayLike | None = None,
        velocities: npt.ArrayLike | None = None,
        spins: npt.ArrayLike | None = None,
        *,
        name: str | None = None,
        colour: str | None = None,
        label: str | None = None,
        look: LookName | None = None,
    ) -> RigidBodies:
        """Add rigid bodies of one shape. Their spheres and rods are spheres and rods of the scene.

        Parameters
        ----------
        shape : int
            Number of the shape, as :meth:`add_shape` returned it.
        positions : array_like, shape (N, 3) or (3,)
            Where the origin of the shape comes to lie, in units.
        orientations : array_like, shape (N, 4) or (4,), optional
            Unit quaternions w, x, y, z, which turn coordinates of the shape into those of the world.
        velocities : array_like, shape (N, 3) or (3,), optional
            Velocities of the centres of mass, in units/s.
        spins : array_like, shape (N, 3) or (3,), optional
            Angular velocities along the axes of the world, in rad/s.
        name, colour, label, look : str, optional
            Name, colour, label and look of the bodies. See :meth:`set_tag`.

        Returns
        -------
        RigidBodies
            Numbers of the bodies, their spheres and their rods.

        Raises
        ------
        ValueError, TypeError
            As for :meth:`add_spheres`.
        LookupError
            For a shape that does not exist.
        """
        tag = tag_of(name, colour, label, look)
        count, arrays = columns(
            positions=(positions, VECTOR),
            orientations=(_UPRIGHT if orientations is None else orientations, QUATERNION),
            velocities=(_ZERO if velocities is None else velocities, VECTOR),
            spins=(_ZERO if spins is None else spins, VECTOR),
        )
        self._edited()
        (body, sphere, rod), (spheres, rods) = _rockfall.add_bodies(self._native, shape_number(shape), *arrays)
        added = RigidBodies(
            numbers_from(body, count),
            numbers_from(sphere, count * spheres).reshape(count, spheres),
            numbers_from(rod, count * rods).reshape(count, rods),
        )
        self._put_tag("body", added.bodies, tag)
        return added

    def add_body(
        self,
        shape: int,
        position: npt.ArrayLike,
        orientation: npt.ArrayLike | None = None,
        velocity: npt.ArrayLike | None = None,
        spin: npt.ArrayLike | None = None,
        *,
        name: str | None = None,
        colour: str | None = None,
        label: str | None = None,
        look: LookName | None = None,
    ) -> int:
        """Add one rigid body and return its number. The options are those of :meth:`add_bodies`."""
        rows = [floats("position", position, (3,))]
        if len(rows[0]) != 1:
            raise ValueError(f"position: expected shape (3,), got {np.shape(position)}")
        tags: dict[str, Any] = {"name": name, "colour": colour, "label": label, "look": look}
        return first_of(self.add_bodies(shape, rows[0], orientation, velocity, spin, **tags).bodies)

    @property
    def bodies(self) -> BodyStates:
        """States of all rigid bodies.

        ``bodies.positions``, ``orientations``, ``velocities`` and ``angular_momenta``, and their external ``forces`` and ``torques``.
        """
        return BodyStates(self)

    def set_bodies(
        self,
        bodies: npt.ArrayLike,
        *,
        positions: npt.ArrayLike | None = None,
        orientations: npt.ArrayLike | None = None,
        velocities: npt.ArrayLike | None = None,
        angular_momenta: npt.ArrayLike | None = None,
        forces: npt.ArrayLike | None = None,
        torques: npt.ArrayLike | None = None,
    ) -> None:
        """Set the states of rigid bodies, and the forces on them. What is not given stays. Their spheres follow.

        A change of the forces and torques alone is cheap: a controller may do it in every step.

        Parameters
        ----------
        bodies : array_like of int, shape (N,) or ()
            Numbers of bodies, as :meth:`add_bodies` returned them, each once.
        positions : array_like, shape (N, 3) or (3,), optional
            Centres of mass, in units.
        orientations : array_like, shape (N, 4) or (4,), optional
            Unit quaternions w, x, y, z, which turn coordinates of the shape into those of the world.
        velocities : array_like, shape (N, 3) or (3,), optional
            Velocities of the centres of mass, in units/s.
        angular_momenta : array_like, shape (N, 3) or (3,), optional
            Angular momenta about the centres of mass along the axes of the world, in mass units²/s.
        forces, torques : array_like, shape (N, 3) or (3,), optional
            External forces at the centres of mass in mass units/s², and external torques about them in mass units²/s², along the
            axes of the world. They act until they are changed, under the contact law ``rigid`` alone.

        Raises
        ------
        LookupError
            For a body that does not exist.
        ValueError
            For another shape, numbers that are not finite, and quaternions that are not unit quaternions. Nothing is set then.
        """
        numbers = np.atleast_1d(integers("bodies", bodies))
        given = [
            ("positions", "position", positions, VECTOR),
            ("orientations", "orientation", orientations, QUATERNION),
            ("velocities", "velocity", velocities, VECTOR),
            ("angular_momenta", "angular_momentum", angular_momenta, VECTOR),
            ("forces", "force", forces, VECTOR),
            ("torques", "torque", torques, VECTOR),
        ]
        fields = [
            (field, kind.convert(name, value, len(numbers)))
            for name, field, value, kind in given
            if value is not None
        ]
        self._edited()
        _rockfall.set_bodies(self._native, numbers, fields)

    def apply_body_impulses(
        self, bodies: npt.ArrayLike, impulses: npt.ArrayLike, points: npt.ArrayLike | None = None
    ) -> None:
        """Apply impulses to rigid bodies at once.

        Each velocity changes by impulse / mass, and each angular momentum by the moment of the impulse about the centre of mass.

        Parameters
        ----------
        bodies : array_like of int, shape (N,) or ()
            Numbers of bodies, as :meth:`add_bodies` returned them.
        impulses : array_like, shape (N, 3) or (3,)
            Impulses, in mass units/s.
        points : array_like, shape (N, 3) or (3,), optional
            Points of the scene at which they act, in units; by default the centres of mass.

        Raises
        ------
        LookupError
            For a body that does not exist.
        ValueError
            For another shape and numbers that are not finite. Nothing changes then.
        """
        self._push_bodies("impulse", bodies, impulses, points)

    def add_body_forces(
        self, bodies: npt.ArrayLike, forces: npt.ArrayLike, points: npt.ArrayLike | None = None
    ) -> None:
        """Add forces at points of rigid bodies to their external forces and torques: see :meth:`set_bodies`.

        They act until forces and torques are changed, and do not follow the points. Parameters and errors are those of
        :meth:`apply_body_impulses`, with forces in mass units/s².
        """
        self._push_bodies("force", bodies, forces, points)

    def _push_bodies(
        self, what: str, bodies: npt.ArrayLike, rows: npt.ArrayLike, points: npt.ArrayLike | None
    ) -> None:
        numbers = np.atleast_1d(integers("bodies", bodies))
        rows = VECTOR.convert(f"{what}s", rows, len(numbers))
        places = None
        if points is not None:
            given = np.asarray(points, dtype=np.float64)
            VECTOR.convert("points", given, len(numbers))
            places = np.ascontiguousarray(np.broadcast_to(given, (len(numbers), 3))).reshape(-1)
        self._edited()
        _rockfall.push_bodies(self._native, what, numbers, rows, places)

    def remove_bodies(self, bodies: npt.ArrayLike) -> None:
        """Remove rigid bodies, by their numbers, with their spheres and rods and everything attached to them.

        Raises
        ------
        LookupError
            For a body that does not exist. Nothing is removed then.
        """
        numbers = np.unique(integers("bodies", bodies))
        self._edited()
        _rockfall.remove(self._native, "body", numbers)
