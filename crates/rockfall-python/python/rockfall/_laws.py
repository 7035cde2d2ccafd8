"""Forces that a program defines."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from rockfall import _rockfall

#: A law as the native part takes it: name, WGSL text, parameters.
NativeLaw = tuple[str, str, list[tuple[str, float]]]


class ForceLaw:
    """A force on every moving sphere, as an expression or as text in WGSL. It moves rods and capsules through their spheres.

    Expressions and text read ``position``, ``velocity``, ``angular_velocity`` (vectors of three, ``vec3f``), ``mass``, ``radius``,
    ``time`` (numbers, ``f32``) and the parameters, by name.

    Parameters
    ----------
    name : str
        Name of the law. A simulation has at most one law of a name.
    force : str, optional
        Expression in WGSL for the force, a vector in mass units/s².
    torque : str, optional
        Expression in WGSL for the torque, a vector in mass units²/s².
    wgsl : str, optional
        In place of expressions: the body of a function in WGSL that sets ``force`` and, if it needs to, ``torque``.
    parameters : mapping of str to float, optional
        Names and values of the parameters. :meth:`Simulation.set_force_law_parameter` changes them in a run.

    Raises
    ------
    TypeError, ValueError
        For arguments of other types, without a force, or with expressions and text. Expressions and text are checked by the
        simulation that gets the law.

    Examples
    --------
    >>> trap = rf.ForceLaw("trap", "-k * position", parameters={"k": 4.0})
    >>> field = rf.ForceLaw("field", "q * cross(velocity, vec3f(0.0, 0.0, b))", parameters={"q": 1.0, "b": 2.0})
    >>> scene = rf.Scene()
    >>> ball = scene.add_sphere([1, 0, 0], 0.1)
    >>> sim = rf.Simulation(scene, force_laws=[trap, field])
    >>> sim.set_force_law_parameter("trap", "k", 1.0)
    """

    def __init__(
        self,
        name: str,
        force: str | None = None,
        *,
        torque: str | None = None,
        wgsl: str | None = None,
        parameters: Mapping[str, float] | None = None,
    ) -> None:
        for argument, value in (("name", name), ("force", force), ("torque", torque), ("wgsl", wgsl)):
            if not isinstance(value, str) and (value is not None or argument == "name"):
                raise TypeError(f"{argument}: expected a str, got {type(value).__name__}")
        if (wgsl is None) == (force is None and torque is None):
            raise ValueError(f"force law {name!r}: expected expressions for force and torque, or wgsl, but not both")
        self.name = name
        if wgsl is None:
            lines = (("force", force), ("torque", torque))
            wgsl = "\n".join(f"{target} = {expression};" for target, expression in lines if expression is not None)
        #: The text in WGSL.
        self.wgsl = wgsl
        #: Names and values of the parameters.
        self.parameters = {key: law_number(f"parameters[{key!r}]", value) for key, value in (parameters or {}).items()}

    @property
    def _native(self) -> NativeLaw:
        return (self.name, self.wgsl, list(self.parameters.items()))

    def __repr__(self) -> str:
        return f"rockfall.ForceLaw({self.name!r}, wgsl={self.wgsl!r}, parameters={self.parameters!r})"


def law_number(name: str, value: Any) -> float:
    if isinstance(value, (bool, str)):
        raise TypeError(f"{name}: expected a number, got {type(value).__name__}")
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{name}: expected a number, got {type(value).__name__}") from None
    with np.errstate(over="ignore"):
        is_finite = bool(np.isfinite(np.float32(number)))
    if not is_finite:
        raise ValueError(f"{name}: expected a finite number (in the range of float32), got {value!r}")
    return number


def native_laws(laws: Iterable[ForceLaw]) -> list[NativeLaw]:
    """The laws as the native part takes them."""
    found = []
    for law in laws:
        if not isinstance(law, ForceLaw):
            raise TypeError(f"force_laws: expected rockfall.ForceLaw, got {type(law).__name__}")
        found.append(law._native)
    return found


class LawTable:
    """The force laws of a simulation. A base of :class:`Simulation`."""

    _native: Any

    def _edited(self) -> None:
        """Called before objects are added, removed or changed."""

    @property
    def force_laws(self) -> tuple[ForceLaw, ...]:
        """The forces that were defined, in the order in which they act, with the present values of their parameters."""
        laws = _rockfall.force_laws(self._native)
        return tuple(ForceLaw(name, wgsl=wgsl, parameters=dict(parameters)) for name, wgsl, parameters in laws)

    def add_force_law(
        self,
        name: str | ForceLaw,
        force: str | None = None,
        *,
        torque: str | None = None,
        wgsl: str | None = None,
        parameters: Mapping[str, float] | None = None,
    ) -> None:
        """Define a force on every moving sphere, from the next step on.

        Parameters
        ----------
        name : str or ForceLaw
            A law, or its name. The other arguments are those of :class:`ForceLaw`.

        Raises
        ------
        ValueError
            For an expression or a text that is wrong, with the line and the column, and for a name that another law has.

        Examples
        --------
        >>> sim = rf.Simulation(rf.Scene())
        >>> sim.add_force_law("trap", "-k * position", parameters={"k": 1.0})
        """
        if isinstance(name, ForceLaw):
            if any(argument is not None for argument in (force, torque, wgsl, parameters)):
                raise TypeError("add_force_law: a ForceLaw takes no further arguments")
            law = name
        else:
            law = ForceLaw(name, force, torque=torque, wgsl=wgsl, parameters=parameters)
        self._edited()
        _rockfall.add_force_law(self._native, law._native)

    def remove_force_law(self, name: str) -> None:
        """Remove a force that was defined. Raises ValueError if there is no law of this name."""
        self._edited()
        _rockfall.remove_force_law(self._native, name)

    def set_force_law_parameter(self, name: str, parameter: str, value: float) -> None:
        """Change a parameter of a force law from the next step on.

        Raises
        ------
        ValueError
            If there is no law of this name, for a parameter that it does not have, and for a number that is not finite.
        """
        number = law_number("value", value)
        self._edited()
        _rockfall.set_force_law_parameter(self._native, name, parameter, number)
