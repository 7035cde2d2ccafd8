"""Inlets, outlets and sensors: grains and rigid bodies that come and go."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from rockfall import _rockfall
from rockfall._bodies import Bodies
from rockfall._names import tag_of
from rockfall._rigid import shape_number
from rockfall.typing import LookName

_ZERO = (0.0, 0.0, 0.0)


class GrainKind(NamedTuple):
    """Spheres of one kind, or rigid bodies of a shape, in the mixture of an inlet: ``mix`` of :meth:`Scene.add_inlet`. Values have the
    meaning that they have there."""

    #: Name of a kind of spheres, which no other kind of the mixture has.
    name: str = ""
    #: Number of the shape of the bodies.
    shape: int | None = None
    #: Without a shape: the radius in units, the two ends of a range, or ``"lognormal:median,sigma"``.
    radius: float | tuple[float, float] | str | None = None
    #: What the distribution of radii counts: ``"number"`` or ``"mass"``.
    by: str = "number"
    #: Mass of a sphere.
    mass: float | None = None
    #: Density in mass/units³.
    density: float | None = None
    #: Collision group from 0 to 65535.
    group: int = 0
    #: Material, by number or by name.
    material: int | str | None = None
    #: Colour of the spheres.
    colour: str | None = None
    #: Label of the spheres.
    label: str | None = None
    #: Look of the spheres.
    look: LookName | None = None


class Inflow(NamedTuple):
    """What came in through an inlet."""

    #: Number of spheres that came in.
    spheres: int
    #: Their mass.
    mass: float
    #: Number of spheres that are due and not in yet, because there is no room or the inlet acts in a later step; at most 65,536.
    waiting: int


class Outflow(NamedTuple):
    """What left through an outlet."""

    #: Number of spheres that left.
    spheres: int
    #: Their mass.
    mass: float


class Flow(NamedTuple):
    """What came in and left since the start of a simulation, as :attr:`Simulation.flow` returns it. The ends of a capsule count as
    two spheres, and a rigid body as one."""

    #: The inlets, by name.
    inlets: dict[str, Inflow]
    #: The outlets, by name.
    outlets: dict[str, Outflow]
    #: Number of spheres in the scene that are not fixed.
    spheres: int
    #: Their mass.
    mass: float


def _corners(low: npt.ArrayLike, high: npt.ArrayLike) -> list[list[float]]:
    corners = []
    for name, value in (("low", low), ("high", high)):
        array = np.asarray(value, dtype=np.float64)
        if array.shape != (3,):
            raise ValueError(f"{name}: expected shape (3,), got {array.shape}")
        corners.append([float(number) for number in array])
    return corners


def _radius(radius: float | tuple[float, float] | str) -> str:
    if isinstance(radius, str):
        return radius
    numbers = np.asarray(radius, dtype=np.float64)
    if numbers.shape not in ((), (2,)):
        raise ValueError(f"radius: expected a number, a pair or 'lognormal:median,sigma', got shape {numbers.shape}")
    return "..".join(repr(float(number)) for number in np.atleast_1d(numbers))


class Flows(Bodies):
    """Adds inlets, outlets and sensors. A base of :class:`Objects`."""

    def add_inlet(
        self,
        name: str,
        low: npt.ArrayLike,
        high: npt.ArrayLike,
        *,
        rate: float | None = None,
        mass_rate: float | None = None,
        volume_rate: float | None = None,
        shape: int | None = None,
        radius: float | tuple[float, float] | str | None = None,
        by: Literal["number", "mass"] = "number",
        mass: float | None = None,
        density: float | None = None,
        velocity: npt.ArrayLike = _ZERO,
        start: float = 0.0,
        end: float = np.inf,
        limit: int | None = None,
        seed: int = 0,
        every: int | None = None,
        group: int = 0,
        material: int | str | None = None,
        colour: str | None = None,
        label: str | None = None,
        look: LookName | None = None,
        mix: Iterable[tuple[GrainKind, float]] | None = None,
    ) -> None:
        """Add a box in which spheres, or rigid bodies of a shape, appear while a simulation runs. What is said of spheres below is also
        said of bodies.

        Radii, places and orientations are random, without overlaps, and follow from the seed. A sphere for which there is no room waits. How steps are
        divided into calls of :meth:`Simulation.run` does not matter.

        Parameters
        ----------
        name : str
            One word that no other inlet has as its name.
        low, high : array_like, shape (3,)
            Two opposite corners of the box, in units. Spheres appear wholly inside it.
        rate, mass_rate, volume_rate : float
            One of them: spheres, mass, or volume of spheres in units³, per second. Bodies have no volume rate.
        shape : int, optional
            Number of the shape of the bodies, as :meth:`add_shape` returned it. It has its own size, mass, materials and groups.
        radius : float, pair of floats or str
            Without a shape: the radius in units, the two ends of a range, or ``"lognormal:median,sigma"``.
        by : {"number", "mass"}
            What the distribution of radii counts, or the shares of a mixture.
        mass, density : float, optional
            Mass of a sphere, or its density in mass/units³. By default that of the material, else a mass of 1.
        velocity : array_like, shape (3,)
            Velocity with which spheres appear, in units/s.
        start, end : float
            Times in s from and up to which spheres become due.
        limit : int, optional
            Greatest number of spheres.
        seed : int
            Seed of the radii and places.
        every : int, optional
            Number of steps between two times at which spheres may appear. By default it follows from radii, velocity and gravity.
        group : int
            Collision group from 0 to 65535.
        material : int or str, optional
            Material, by number or by name. See :meth:`add_material`.
        colour, label, look : str, optional
            Colour, label and look of the spheres. See :meth:`set_tag`.
        mix : iterable of (GrainKind, float), optional
            In place of a shape or a radius: kinds with their shares. Shares of 1 and 3 are a quarter and three quarters, of the
            spheres or, with ``by="mass"``, of the mass. Size, mass, material, group and tag are those of each kind.

        Raises
        ------
        ValueError
            For numbers out of range, a mixture with kinds of the same name, a box that is too small for the largest sphere, and a
            name that is in use.
        TypeError
            For a shape together with a radius, mass or density, for none of a shape, a radius and a mixture, and for a mixture
            together with values that its kinds have.
        LookupError
            For a shape or a material that does not exist.
        """
        rates = {"rate": rate, "mass_rate": mass_rate, "volume_rate": volume_rate}
        given = [(key, float(value)) for key, value in rates.items() if value is not None]
        if len(given) != 1:
            raise TypeError(f"rate, mass_rate, volume_rate: expected one of them, got {len(given)}")
        own = GrainKind("", shape, radius, by, mass, density, group, material, colour, label, look)
        if mix is None:
            kinds = [(own, 1.0)]
        elif own == GrainKind(by=by):
            kinds = list(mix)
        else:
            raise TypeError("mix: expected no shape, radius, mass, density, group, material, colour, label and look beside it")
        corners = _corners(low, high)
        feed = {
            "rate": given[0],
            "shares": by if mix is not None else "number",
            "velocity": [float(number) for number in np.asarray(velocity, np.float64)],
            "times": (float(start), float(end)),
            "limit": limit,
            "seed": seed,
            "every": every,
        }
        grains = [self._grains(kind, share) for kind, share in kinds]
        self._edited()
        _rockfall.add_inlet(self._native, name, corners, feed, grains)

    def _grains(self, kind: GrainKind, share: float) -> dict[str, object]:
        """Check a kind and give its values as the native module takes them."""
        shape, radius, mass, density = kind.shape, kind.radius, kind.mass, kind.density
        if mass is not None and density is not None:
            raise TypeError("mass, density: expected at most one of them")
        if (shape is None) == (radius is None):
            raise TypeError(f"shape, radius: expected one of them, got {'none' if shape is None else 'both'}")
        if shape is not None and (mass is not None or density is not None):
            raise TypeError("mass, density: expected none with a shape, which has its own mass")
        return {
            "share": float(share),
            "name": kind.name,
            "shape": None if shape is None else shape_number(shape),
            "radius": None if radius is None else _radius(radius),
            "by": kind.by,
            "mass": None if mass is None else float(mass),
            "density": None if density is None else float(density),
            "group": kind.group,
            "material": int(self._material_numbers("material", kind.material)),
            "tag": tag_of(None, kind.colour, kind.label, kind.look),
        }

    def add_outlet(self, name: str, low: npt.ArrayLike, high: npt.ArrayLike, *, every: int | None = None) -> None:
        """Add a box in which spheres disappear, with their rods, springs and tethers. A capsule disappears when its middle enters.

        Parameters
        ----------
        name : str
            One word that no other outlet has as its name.
        low, high : array_like, shape (3,)
            Two opposite corners of the box, in units.
        every : int, optional
            Number of steps between two looks at the box. By default it follows from the box and gravity.

        Raises
        ------
        ValueError
            For a box without volume, and a name that is in use.
        """
        corners = _corners(low, high)
        self._edited()
        _rockfall.add_outlet(self._native, name, corners, every)

    def add_sensor(self, name: str, low: npt.ArrayLike, high: npt.ArrayLike) -> None:
        """Add a box that reports which bodies, capsules and spheres enter and leave it by their centres, and pushes nothing.

        See :meth:`Simulation.watch_sensors` and :meth:`Simulation.sensor_events`.

        Parameters
        ----------
        name : str
            One word that no other sensor has as its name.
        low, high : array_like, shape (3,)
            Two opposite corners of the box, in units.

        Raises
        ------
        ValueError
            For a box without volume, and a name that is in use.
        """
        corners = _corners(low, high)
        self._edited()
        _rockfall.add_sensor(self._native, name, corners)
