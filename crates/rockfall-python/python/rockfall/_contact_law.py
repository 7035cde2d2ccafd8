"""The contact law that a program defines."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from rockfall import _rockfall
from rockfall._expressions import to_wgsl
from rockfall._laws import law_number

#: A contact law as the native part takes it: name, WGSL text, parameters, parameters of pairs.
NativeContactLaw = tuple[str, str, list[tuple[str, float]], list[tuple[str, str, str, float]]]

#: What expressions may use, with the parameters.
INPUTS = ("overlap", "speed", "radius", "mass", "young", "shear")


class Impact(NamedTuple):
    """A central impact of two bodies by a contact law (:meth:`ContactLaw.impact`)."""

    #: Time from the first touch until the force ends, in s. A 20th of it is a time step that resolves the impact.
    seconds: float
    #: Largest overlap, in units.
    overlap: float
    #: Speed of the rebound per speed of the impact.
    restitution: float


class ContactLaw:
    """A contact law, as expressions of Python or as text in WGSL: the normal force, and the tangential spring.

    Friction up to Coulomb's limit, the memory of the tangential spring, resistance to rolling and twisting, and cohesion are those of
    the laws "linear" and "hertz-mindlin". The law gives the damping: the ``restitution`` of pairs has no effect.

    Expressions and text read ``overlap`` (units), ``speed`` (units/s, at which the overlap grows), the reduced ``radius`` and
    ``mass`` of the two bodies, ``young`` and ``shear`` (E* and G* of the two materials; 0 unless both have ``young`` and
    ``poisson``), and the parameters, by name.

    Expressions may use ``+ - * / **``, ``a if b else c``, comparisons, ``and``, ``or``, ``not``, and the functions abs, atan,
    clamp, cos, exp, log, max, min, pow, sign, sin, sqrt, tan and tanh. The base of a power must not be negative unless the exponent
    is a whole number up to 8.

    Parameters
    ----------
    name : str
        Name of the law.
    normal_force : str, optional
        Expression for the normal force, in mass units/s². A positive one pushes the bodies apart. A negative one counts as 0.
    tangential_stiffness : str, optional
        Expression for the tangential force per displacement, in mass/s². 0 if it is not given.
    tangential_damping : str, optional
        Expression for the tangential force per velocity, in mass/s. 0 if it is not given.
    wgsl : str, optional
        In place of expressions: the body of a function in WGSL that sets ``normal_force`` and, if it needs to,
        ``tangential_stiffness`` and ``tangential_damping`` (``f32``).
    parameters : mapping of str to float, optional
        Names and values of up to 8 parameters. :meth:`Simulation.set_contact_law_parameter` changes them in a run.
    pair_parameters : mapping of (str, str) to mapping of str to float, optional
        Values of parameters for the contacts of two materials, by their names.

    Raises
    ------
    TypeError, ValueError
        For arguments of other types, without a normal force, with expressions and text, and for a mistake in an expression, with line
        and column. Text is checked by the simulation that gets the law.

    Examples
    --------
    >>> law = rf.ContactLaw("soft", "k * overlap**1.5 + c * speed", parameters={"k": 1e5, "c": 2.0})
    >>> scene = rf.Scene()
    >>> balls = scene.add_spheres([[0, 0, 0], [1, 0, 0]], 0.5, velocity=[[1, 0, 0], [0, 0, 0]])
    >>> sim = rf.Simulation(scene, 1e-3, contact_law=law)
    >>> sim.set_contact_law_parameter("c", 1.0)
    """

    def __init__(
        self,
        name: str,
        normal_force: str | None = None,
        *,
        tangential_stiffness: str | None = None,
        tangential_damping: str | None = None,
        wgsl: str | None = None,
        parameters: Mapping[str, float] | None = None,
        pair_parameters: Mapping[tuple[str, str], Mapping[str, float]] | None = None,
    ) -> None:
        expressions = {
            "normal_force": normal_force,
            "tangential_stiffness": tangential_stiffness,
            "tangential_damping": tangential_damping,
        }
        for argument, value in (("name", name), *expressions.items(), ("wgsl", wgsl)):
            if not isinstance(value, str) and (value is not None or argument == "name"):
                raise TypeError(f"{argument}: expected a str, got {type(value).__name__}")
        if (wgsl is None) == (normal_force is None) or (wgsl is not None and any(expressions.values())):
            raise ValueError(f"contact law {name!r}: expected an expression for normal_force, or wgsl, but not both")
        self.name = name
        #: Names and values of the parameters.
        self.parameters = {key: law_number(f"parameters[{key!r}]", value) for key, value in (parameters or {}).items()}
        #: Values of parameters for pairs of materials.
        self.pair_parameters = {
            _pair(materials): {key: law_number(f"pair_parameters[{materials!r}][{key!r}]", value) for key, value in own.items()}
            for materials, own in (pair_parameters or {}).items()
        }
        if wgsl is None:
            names = {*INPUTS, *self.parameters}
            given = {target: text for target, text in expressions.items() if text is not None}
            what = f"contact law {name!r}, "
            wgsl = "\n".join(f"{target} = {to_wgsl(what + target, text, names)};" for target, text in given.items())
        #: The text in WGSL.
        self.wgsl = wgsl

    def impact(
        self, speed: float, *, mass: float = 1.0, radius: float = 1.0, young: float = 0.0, shear: float = 0.0
    ) -> Impact | None:
        """Compute a central impact of two bodies by the law, which shows its time step and its restitution.

        Parameters
        ----------
        speed : float
            Speed at which the bodies approach each other, in units/s.
        mass, radius : float
            Reduced mass and radius: those of two equal balls are half of the mass and the radius of each.
        young, shear : float
            E* and G* of the two materials.

        Returns
        -------
        Impact or None
            None if the law does not make the bodies rebound.

        Raises
        ------
        ValueError
            For a mistake in the text of the law, and for numbers that are not finite.
        """
        given = {"speed": speed, "mass": mass, "radius": radius, "young": young, "shear": shear}
        found = _rockfall.impact(self._native, [law_number(key, value) for key, value in given.items()])
        return None if found is None else Impact(*found)

    @property
    def _native(self) -> NativeContactLaw:
        pairs = [(*materials, name, value) for materials, own in self.pair_parameters.items() for name, value in own.items()]
        return (self.name, self.wgsl, list(self.parameters.items()), pairs)

    def __repr__(self) -> str:
        return (
            f"rockfall.ContactLaw({self.name!r}, wgsl={self.wgsl!r}, parameters={self.parameters!r}, "
            f"pair_parameters={self.pair_parameters!r})"
        )


def _pair(materials: Any) -> tuple[str, str]:
    is_pair = isinstance(materials, tuple) and len(materials) == 2
    if not is_pair or not all(isinstance(name, str) for name in materials):
        raise TypeError(f"pair_parameters: expected two names of materials, got {materials!r}")
    return (materials[0], materials[1])


def native_contact_law(law: ContactLaw | None) -> NativeContactLaw | None:
    """The law as the native part takes it."""
    if law is not None and not isinstance(law, ContactLaw):
        raise TypeError(f"contact_law: expected rockfall.ContactLaw, got {type(law).__name__}")
    return None if law is None else law._native


class ContactLawOf:
    """The contact law of a simulation. A base of :class:`Simulation`."""

    _native: Any

    def _edited(self) -> None:
        """Called before objects are added, removed or changed."""

    @property
    def contact_law(self) -> ContactLaw | None:
        """The contact law that was defined, with the present values of its parameters, or None."""
        law = _rockfall.contact_law(self._native)
        if law is None:
            return None
        name, wgsl, parameters, given = law
        pairs: dict[tuple[str, str], dict[str, float]] = {}
        for one, other, parameter, value in given:
            pairs.setdefault((one, other), {})[parameter] = value
        return ContactLaw(name, wgsl=wgsl, parameters=dict(parameters), pair_parameters=pairs)

    def set_contact_law_parameter(self, parameter: str, value: float, *, materials: tuple[str, str] | None = None) -> None:
        """Change a parameter of the contact law that was defined, from the next step on.

        Parameters
        ----------
        parameter : str
            Name of the parameter.
        value : float
            Its value.
        materials : (str, str), optional
            Names of the materials whose contacts get the value. Without them, all pairs get it that have no value of their own.

        Raises
        ------
        ValueError
            If the simulation has no such law, for a parameter or a material that it does not have, and for a number that is not
            finite.
        """
        number = law_number("value", value)
        pair = None if materials is None else _pair(materials)
        self._edited()
        _rockfall.set_contact_law_parameter(self._native, parameter, number, pair)
