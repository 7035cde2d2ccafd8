"""Materials, and the properties of their pairs."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from rockfall import _rockfall
from rockfall._arrays import IntArray, floats
from rockfall.typing import CohesionName, RollingModelName

#: Materials of objects: numbers or names, one for all or one per object. None stands for no material.
Materials: TypeAlias = npt.ArrayLike | str | None | Sequence[str | None]

_NONE = -1


class Material(NamedTuple):
    """A material, as :attr:`Objects.materials` lists it. Constants that are None are not known."""

    #: Name.
    name: str
    #: Density, in mass/units³.
    density: float | None
    #: Young's modulus, in mass/(units s²).
    young: float | None
    #: Poisson's ratio.
    poisson: float | None


class Pair(NamedTuple):
    """Properties of the contacts between two materials.

    Where restitution or friction is None, the constants of the scene hold. Where the coefficient of a resistance or the surface
    energy is None, there is no such resistance or cohesion.
    """

    #: Coefficient of restitution.
    restitution: float | None
    #: Coefficient of Coulomb friction.
    friction: float | None
    #: Normal stiffness of the contact law ``linear``, in mass/s².
    stiffness: float | None
    #: Velocity for the stiffness of ``linear`` where none is given, in units/s.
    characteristic_velocity: float | None = None
    #: Coefficient of rolling friction of the laws ``linear`` and ``hertz-mindlin``.
    rolling_friction: float | None = None
    #: Damping ratio of the rolling model "c"; 0.3 where it is None.
    rolling_damping: float | None = None
    #: Coefficient of twisting friction of these laws.
    twisting_friction: float | None = None
    #: Surface energy of these laws, in mass/s².
    surface_energy: float | None = None
    #: Model of the resistance to rolling: "a", a constant torque, or "c", a spring and a dashpot. "c" where it is None.
    rolling_model: RollingModelName | None = None
    #: Model of the cohesion: "dmt", a constant attraction in contacts, or "jkr", necks. "dmt" where it is None.
    cohesion: CohesionName | None = None


class MaterialTable:
    """The materials of a scene. A base of :class:`Objects`."""

    _native: Any

    def _edited(self) -> None:
        """Called before objects are added, removed or changed."""

    def add_material(
        self, name: str, *, density: float | None = None, young: float | None = None, poisson: float | None = None
    ) -> int:
        """Add a material.

        Objects have the material that they are added with (``material=`` of the ``add`` methods), by its number or by its name.
        The contact laws ``linear`` and ``hertz-mindlin`` (``settings.contact_law``) need materials.

        Parameters
        ----------
        name : str
            A word that no other material of the scene has as its name.
        density : float, optional
            Density in mass/units³, greater than 0. Spheres and capsules with ``mass=None`` have the mass that follows from it.
        young : float, optional
            Young's modulus in mass/(units s²), greater than 0.
        poisson : float, optional
            Poisson's ratio, at least 0 and less than 0.5.

        Returns
        -------
        int
            Number of the material. Materials count from 0.

        Raises
        ------
        ValueError
            For a constant that is out of range, a name that is not one word or is taken, and for more than 255 materials.
        """
        if not isinstance(name, str):
            raise TypeError(f"name: expected a str, got {type(name).__name__}")
        constants = (_known("density", density), _known("young", young), _known("poisson", poisson))
        self._edited()
        return _rockfall.add_material(self._native, name, constants)

    def update_material(
        self,
        material: int | str,
        *,
        density: float | None = None,
        young: float | None = None,
        poisson: float | None = None,
    ) -> None:
        """Change constants of a material. Masses that were computed from its density stay. Raises as :meth:`add_material`."""
        number = self._material_number("material", material)
        constants = (_known("density", density), _known("young", young), _known("poisson", poisson))
        self._edited()
        _rockfall.update_material(self._native, number, constants)

    def set_pair(
        self,
        one: int | str,
        other: int | str,
        *,
        restitution: float | None = None,
        friction: float | None = None,
        stiffness: float | None = None,
        characteristic_velocity: float | None = None,
        rolling_friction: float | None = None,
        rolling_model: RollingModelName | None = None,
        rolling_damping: float | None = None,
        twisting_friction: float | None = None,
        surface_energy: float | None = None,
        cohesion: CohesionName | None = None,
    ) -> None:
        """Set properties of the contacts between two materials, or of a material with itself. Those that are not given stay as they are.

        Parameters
        ----------
        one, other : int or str
            The materials, by number or by name.
        restitution : float, optional
            Coefficient of restitution, from 0 to 1.
        friction : float, optional
            Coefficient of Coulomb friction, not negative.
        stiffness : float, optional
            Normal stiffness of the contact law ``linear`` in mass/s², greater than 0.
        characteristic_velocity : float, optional
            Velocity in units/s, greater than 0, from which and from the elastic constants of the materials the law ``linear`` takes
            its stiffness: impacts at this velocity are as deep as with Hertz's law.
        rolling_friction, twisting_friction : float, optional
            Coefficients of friction against rolling and against spinning about the normal, not negative. Only the laws
            ``linear`` and ``hertz-mindlin`` use these properties and the following ones.
        rolling_model : {"c", "a"}, optional
            "c", the default, is a spring and a dashpot, with which bodies come to rest; "a" is a constant torque.
        rolling_damping : float, optional
            Damping ratio of "c", not negative; 0.3 if it is not given.
        surface_energy : float, optional
            Surface energy gamma in mass/s², not negative: objects in contact attract each other.
        cohesion : {"dmt", "jkr"}, optional
            "dmt", the default, is a constant attraction of 4 pi gamma R* while objects overlap. "jkr", for the law
            ``hertz-mindlin``, is a neck that holds objects together until they are apart by a short distance, with a pull-off
            force of 3 pi gamma R*.

        Raises
        ------
        ValueError
            For a property that is out of range.
        LookupError
            For a material that does not exist.
        """
        numbers = (self._material_number("one", one), self._material_number("other", other))
        for name, model in (("rolling_model", rolling_model), ("cohesion", cohesion)):
            if model is not None and not isinstance(model, str):
                raise TypeError(f"{name}: expected a str, got {type(model).__name__}")
        properties = [
            _known("restitution", restitution),
            _known("friction", friction),
            _known("stiffness", stiffness),
            _known("characteristic_velocity", characteristic_velocity),
            _known("rolling_friction", rolling_friction),
            _known("rolling_damping", rolling_damping),
            _known("twisting_friction", twisting_friction),
            _known("surface_energy", surface_energy),
        ]
        self._edited()
        _rockfall.set_pair(self._native, *numbers, (properties, [rolling_model, cohesion]))

    def pair(self, one: int | str | None, other: int | str | None) -> Pair:
        """The properties of the contacts between two materials; None stands for objects without a material.

        A property that was not set for the pair is the geometric mean (of stiffnesses, the harmonic mean) of those of each
        material with itself. If it was set for only one of them, it is that value. If it was set for none, it is None. Two
        different rolling models give "c", and two different models of cohesion "dmt".
        """
        numbers = [_NONE if of is None else self._material_number(name, of) for name, of in (("one", one), ("other", other))]
        properties, models = _rockfall.pair(self._native, *numbers)
        return Pair._make([*properties, *models])

    @property
    def materials(self) -> list[Material]:
        """The materials, in order of addition. The place in the list is the number."""
        return [Material(name, *constants) for name, constants in _rockfall.materials(self._native)]

    def _material_number(self, name: str, value: Any) -> int:
        """The number of one material."""
        numbers = self._material_numbers(name, value)
        if numbers.shape != () or int(numbers) == _NONE:
            raise TypeError(f"{name}: expected the number or the name of a material, got {value!r}")
        return int(numbers)

    def _material_numbers(self, name: str, value: Materials) -> IntArray:
        """Numbers of materials, of shape () or (N,). None becomes -1."""
        array: npt.NDArray[Any] = np.array(_NONE) if value is None else np.asarray(value)
        if array.ndim > 1:
            raise ValueError(f"{name}: expected shape (N,) or (), got {array.shape}")
        if array.dtype.kind in "UO":
            places = {material.name: place for place, material in enumerate(self.materials)}
            found = [self._place(name, item, places) for item in array.reshape(-1).tolist()]
            return np.array(found, dtype=np.int64).reshape(array.shape)
        if array.dtype.kind not in "iu":
            raise TypeError(f"{name}: expected numbers or names of materials, got dtype {array.dtype}")
        if value is not None and (array < 0).any():
            raise ValueError(f"{name}: expected numbers of materials from 0, got {int(array.min())}; None stands for none")
        return array.astype(np.int64)

    @staticmethod
    def _place(name: str, item: Any, places: dict[str, int]) -> int:
        if item is None:
            return _NONE
        if isinstance(item, (int, np.integer)) and not isinstance(item, bool) and item >= 0:
            return int(item)
        if not isinstance(item, str):
            raise TypeError(f"{name}: expected numbers or names of materials, got {item!r}")
        if item not in places:
            known = ", ".join(places) or "none was added"
            raise LookupError(f"{name}: there is no material {item!r}, expected one of: {known}")
        return places[item]


def _known(name: str, value: float | None) -> float | None:
    return None if value is None else float(floats(name, value, (), 1)[0])
