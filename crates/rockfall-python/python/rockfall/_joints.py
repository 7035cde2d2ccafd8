"""Joints between bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from rockfall import _rockfall
from rockfall._arrays import FloatArray, IntArray, integers, vector
from rockfall._bodies import Bodies

if TYPE_CHECKING:
    from rockfall._simulation import Simulation

JointKind = Literal["ball", "hinge", "slider", "fixed", "distance"]
End = int | tuple[Literal["sphere"], int] | None
"""The number of a body, ``("sphere", number)``, or None for the world."""

_ZERO = (0.0, 0.0, 0.0)
_X = (1.0, 0.0, 0.0)


def _end(name: str, end: Any) -> tuple[str, int]:
    if end is None:
        return ("world", 0)
    if isinstance(end, tuple) and len(end) == 2 and end[0] == "sphere":
        return ("sphere", int(end[1]))
    if isinstance(end, (int, np.integer)) and not isinstance(end, bool):
        return ("body", int(end))
    raise TypeError(f'{name}: expected the number of a body, ("sphere", number), or None for the world, got {end!r}')


def _number(name: str, value: Any) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{name}: expected a number, got {type(value).__name__}") from None
    if np.isnan(number):
        raise ValueError(f"{name}: expected a number, got nan")
    return number


class JointObjects(Bodies):
    """Adds joints. A base of :class:`Objects`."""

    def add_joint(
        self,
        kind: JointKind,
        a: End,
        b: End,
        *,
        at: npt.ArrayLike,
        to: npt.ArrayLike | None = None,
        axis: npt.ArrayLike | None = None,
        limits: tuple[float, float] | None = None,
        cone: float | None = None,
        speed: float | None = None,
        max_force: float | None = None,
        target: float | None = None,
        stiffness: float = 0.0,
        damping: float = 0.0,
        effort: float = 0.0,
        drag: float = 0.0,
        armature: float = 0.0,
        friction: float = 0.0,
        break_force: float | None = None,
        break_torque: float | None = None,
        collide: bool = False,
        name: str | None = None,
    ) -> int:
        """Add a joint between two bodies in their present places and return its number. Joints need the contact law ``rigid``,
        which ``"auto"`` chooses for them.

        The position of a joint is the angle in rad of a hinge and of the twist of a ball, the way in units along the axis of a slider,
        or the distance in units of the anchors of a distance joint. Angles and ways are 0 in the present places.

        Parameters
        ----------
        kind : {"ball", "hinge", "slider", "fixed", "distance"}
            What the joint leaves free.
        a, b : int, ("sphere", int) or None
            The number of a body, the number of a sphere, or None for the world. At least one moves.
        at : array_like, shape (3,)
            The anchor in the world, in units.
        to : array_like, shape (3,), optional
            For a distance joint: the anchor on `b`.
        axis : array_like, shape (3,), optional
            Axis of a hinge or a slider, or that of the cone and the twist of a ball; that of x by default.
        limits : pair of float, optional
            Least and greatest position.
        cone : float, optional
            For a ball: the greatest angle in rad between the axes of both bodies.
        speed : float, optional
            Speed of a motor, in rad/s or units/s.
        max_force : float, optional
            Greatest force in mass units/s² or torque in mass units²/s² of the motor, and of the spring with the effort. No bound by
            default.
        target : float, optional
            Position at which the spring rests; that of the start by default.
        stiffness, damping : float, optional
            Of the spring, in force or torque per unit or rad, and per unit/s or rad/s.
        effort : float, optional
            A force along the axis in mass units/s² or a torque about it in mass units²/s², on `b`.
        drag : float, optional
            Damping that `max_force` does not bound.
        armature : float, optional
            Inertia of a rotor that turns with the joint, in mass units², or in mass for one that slides.
        friction : float, optional
            Greatest force or torque of friction.
        break_force, break_torque : float, optional
            The joint breaks at a greater mean force or torque of a step.
        collide : bool, optional
            Whether its bodies collide.
        name : str, optional
            One word, which no other joint has as its name.

        Raises
        ------
        LookupError
            For a body or sphere that does not exist.
        ValueError
            For numbers out of their range, limits that do not contain the position at the start, values that the kind does not have, a
            name that is in use, and ends that are the same body or cannot move.
        """
        if (kind == "distance") != (to is not None):
            raise TypeError("to: expected the anchor on b of a distance joint, and of no other one")
        if axis is not None and kind in ("fixed", "distance"):
            raise TypeError(f"axis: expected none for the kind {kind}")
        place = (vector("at", at), vector("to", at if to is None else to), vector("axis", _X if axis is None else axis, is_direction=True))
        single = {
            "cone": cone, "speed": speed, "max_force": max_force, "target": target, "stiffness": stiffness or None,
            "damping": damping or None, "effort": effort or None, "drag": drag or None, "armature": armature or None,
            "friction": friction or None, "break_force": break_force, "break_torque": break_torque,
        }  # fmt: skip
        if limits is not None:
            if np.shape(limits) != (2,):
                raise ValueError(f"limits: expected two numbers, got shape {np.shape(limits)}")
            single["lower"], single["upper"] = limits
        numbers = [(field, _number(field, value)) for field, value in single.items() if value is not None]
        self._edited()
        return int(_rockfall.add_joint(self._native, kind, (_end("a", a), _end("b", b)), place, numbers, bool(collide), name))

    def remove_joints(self, joints: npt.ArrayLike) -> None:
        """Remove joints, by their numbers.

        Raises
        ------
        LookupError
            For a joint that does not exist. Nothing is removed then.
        """
        numbers = np.unique(integers("joints", joints))
        self._edited()
        _rockfall.remove(self._native, "joint", numbers)

    def set_joints(self, joints: npt.ArrayLike, **numbers: npt.ArrayLike) -> None:
        """Set numbers of joints, from the next step on. This is cheap: a controller may do it in every step.

        Parameters
        ----------
        joints : array_like of int, shape (N,) or ()
            Numbers of joints, as :meth:`add_joint` returned them.
        **numbers : array_like, shape (N,) or ()
            ``speed`` (nan for no motor), ``max_force``, ``target`` (nan for that of the start), ``stiffness``, ``damping``, ``effort``,
            ``drag``, ``armature``, ``friction``, ``lower``, ``upper``, ``cone``, ``length``, ``break_force`` and ``break_torque``, with the units of :meth:`add_joint`.

        Raises
        ------
        LookupError
            For a joint that does not exist.
        TypeError, ValueError
            For another name, another shape, and numbers out of their range. The joints before a wrong one are set.
        """
        ids = np.atleast_1d(integers("joints", joints))
        fields = []
        for field, value in numbers.items():
            array = np.asarray(value, dtype=np.float32)
            if array.shape not in ((), ids.shape):
                raise ValueError(f"{field}: expected shape ({len(ids)},) or (), got {array.shape}")
            fields.append((field, np.broadcast_to(array, ids.shape).tolist()))
        self._edited()
        _rockfall.set_joints(self._native, ids.tolist(), fields)


class JointReadings:
    """What joints do at present.

    N is their number. Joints of worlds have rows for W worlds before that: (W, N) in place of (N,).
    """

    #: Nine numbers for each joint, and whether it is broken.
    _rows: FloatArray
    _broken: npt.NDArray[np.bool_]

    def __len__(self) -> int:
        return int(self._rows.shape[-2])

    def _column(self, columns: int | slice) -> FloatArray:
        array: FloatArray = self._rows[..., columns].copy()
        array.flags.writeable = False
        return array

    @property
    def positions(self) -> FloatArray:
        """Positions of shape (N,), in rad or units."""
        return self._column(0)

    @property
    def speeds(self) -> FloatArray:
        """Rates of the positions of shape (N,), in rad/s or units/s."""
        return self._column(1)

    @property
    def errors(self) -> FloatArray:
        """Distances by which the anchors miss each other, of shape (N,), in units."""
        return self._column(2)

    @property
    def forces(self) -> FloatArray:
        """Forces on the second bodies at the anchors, of shape (N, 3), in mass units/s²: means of the last step."""
        return self._column(slice(3, 6))

    @property
    def torques(self) -> FloatArray:
        """Torques on the second bodies, of shape (N, 3), in mass units²/s²: means of the last step."""
        return self._column(slice(6, 9))

    @property
    def broken(self) -> npt.NDArray[np.bool_]:
        """Whether each is broken, of shape (N,). Its other numbers are 0 then."""
        return self._broken.copy()


class JointStates(JointReadings):
    """What all joints do at present, in order of addition, as :attr:`Simulation.joints` returns them.

    Each attribute is a new array.
    """

    def __init__(self, simulation: Simulation) -> None:
        simulation._commit()
        numbers, broken = _rockfall.joint_readings(simulation._native)
        self._rows = numbers.reshape(-1, 9)
        self._broken = np.array(broken, dtype=np.bool_)
        named = _rockfall.joint_names(simulation._native)
        self._ids, self._names = [number for number, _ in named], [name for _, name in named]

    @property
    def ids(self) -> IntArray:
        """Numbers of the joints, as :meth:`Objects.add_joint` returned them, of shape (N,)."""
        return np.array(self._ids, dtype=np.int64)

    @property
    def names(self) -> list[str | None]:
        """Names; None for a joint without one."""
        return list(self._names)
