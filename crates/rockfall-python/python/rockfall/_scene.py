"""Scenes."""

from __future__ import annotations

import os
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from rockfall import _rockfall
from rockfall._arrays import integers, time_step, whole
from rockfall._look import number
from rockfall._objects import Objects
from rockfall._periodic import AXES
from rockfall.typing import IntegratorName

#: Time step of scenes that have none, in s.
_TIME_STEP = 0.02


class RunDefaults(NamedTuple):
    """How a scene is meant to be run: the line ``@run`` of its text. None stands for a value that the scene does not have."""

    #: Time step, in s.
    dt: float | None = None
    #: "auto", "rk4", "symplectic-euler" or "velocity-verlet".
    integrator: IntegratorName | None = None
    #: Number of steps, for ``rockfall run`` and films of ``rockfall render``.
    steps: int | None = None
    #: Number of steps between two frames that ``rockfall run`` writes.
    every: int | None = None
    #: Number of equal parts of a step. Each is a step of a :class:`Simulation`.
    substeps: int | None = None
    #: Simulated seconds per second of film.
    speed: float | None = None


class Scene(Objects):
    """Objects and physical constants, without time.

    ``Scene()`` is empty. :meth:`parse` and :meth:`load` read a scene text. A :class:`Simulation` takes a copy of a scene, so that
    several simulations can start from the same one.

    Examples
    --------
    >>> import rockfall as rf
    >>> scene = rf.Scene()
    >>> scene.add_box([-5, -1, -5], [5, 0, 5])
    0
    >>> scene.add_spheres([[0, 1, 0], [0, 2, 0]], radius=0.4)
    array([0, 1])
    >>> scene.settings.gravity = 9.81
    """

    def __init__(self) -> None:
        self._native: Any = _rockfall.Scene()

    @classmethod
    def _of(cls, native: Any) -> Scene:
        scene = cls.__new__(cls)
        scene._native = native
        return scene

    def set_periodic(self, axis: str, low: float | None = None, high: float | None = None) -> None:
        """Make the scene periodic along ``axis`` ("x", "y" or "z"), from ``low`` to ``high`` (units). Without bounds it is not.

        Bodies meet the nearest images of each other. Boxes and polygons are not repeated, but may span the box. A sphere or rod may
        not be longer along the axis than half of the period; that is checked when a simulation is made.

        Raises
        ------
        ValueError
            For another axis, or bounds that are not finite or not in ascending order.
        """
        if axis not in AXES:
            raise ValueError(f"axis: expected 'x', 'y' or 'z', got {axis!r}")
        if (low is None) != (high is None):
            raise ValueError("low, high: expected both bounds, or none of them")
        bounds = None if low is None or high is None else [float(low), float(high)]
        _rockfall.set_periodic(self._native, AXES.index(axis), bounds)

    def set_group_meets(self, group: int, meets: npt.ArrayLike) -> None:
        """Set the groups whose objects those of ``group`` touch: ``meets`` has their numbers (0 to 65535), of shape (N,), in any order.

        Without a list, a group touches itself alone. With one, it touches the groups of its list, and itself only if the list has it; and
        those whose lists have it. Needs the contact law ``"rigid"``.

        Raises
        ------
        ValueError
            For numbers that are no groups, or more than 30 groups that have a list or are in one.
        """
        number = int(integers("group", group, 1, dtype=np.uint16)[0])
        listed = integers("meets", meets, dtype=np.uint16)
        _rockfall.set_group_meets(self._native, number, [int(other) for other in listed])

    def group_meets(self, group: int) -> list[int] | None:
        """The groups in the list of ``group`` (:meth:`set_group_meets`), in ascending order. ``None`` without a list."""
        return _rockfall.group_meets(self._native, int(integers("group", group, 1, dtype=np.uint16)[0]))

    def set_shear(self, rate: float | None, *, gradient: str = "y", flow: str = "x") -> None:
        """Shear a periodic scene with ``rate`` (1/s): the box above along the axis ``gradient`` moves along the axis ``flow``, so that
        the mean velocity of the flow grows by ``rate`` per unit. ``None`` ends the shear.

        The scene must be periodic along both axes. It consists of moving spheres, springs, tethers and forces, without
        ``collisions`` as impulses and without ``linear_damping``; that is checked when a simulation is made. Lees and Edwards,
        J. Phys. C 5, 1921 (1972).

        Raises
        ------
        ValueError
            For other axes, the same axis twice, or a rate that is not finite.
        """
        for name, axis in {"gradient": gradient, "flow": flow}.items():
            if axis not in AXES:
                raise ValueError(f"{name}: expected 'x', 'y' or 'z', got {axis!r}")
        shear = None if rate is None else (AXES.index(gradient), AXES.index(flow), float(rate))
        _rockfall.set_shear(self._native, shear)

    @classmethod
    def parse(cls, text: str, name: str = "scene") -> Scene:
        """Read a scene text. ``name`` names its source in messages.

        Lines that are no objects, constants or ``@`` words are comments, also without ``#``. A text of nothing but such comments
        is an error. A text that is empty, or in which every line begins with ``#``, is an empty scene.

        Raises
        ------
        ValueError
            For the first wrong line, with its number, the field and what was expected. For a text that yields nothing.
        """
        if not isinstance(text, str):
            raise TypeError(f"text: expected a str, got {type(text).__name__}")
        found = cls._of(_rockfall.Scene.parse(text, name))
        if found._is_blank():
            _refuse_comments(text, found.warnings, name, "; Scene.load reads a file" if os.path.exists(text.strip()) else "")
        return found

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Scene:
        """Read a scene file.

        Raises
        ------
        OSError
            If the file cannot be read.
        ValueError
            As for :meth:`parse`.
        """
        found = cls._of(_rockfall.Scene.load(os.fspath(path)))
        if found._is_blank():
            with open(path, encoding="utf-8", errors="replace") as file:
                _refuse_comments(file.read(), found.warnings, os.fspath(path))
        return found

    def _is_blank(self) -> bool:
        """Whether the scene is that of an empty text."""
        return not any(self.counts) and self.to_text() == Scene().to_text()

    def to_text(self) -> str:
        """The scene as text, which :meth:`parse` reads back to the same bits."""
        text: str = self._native.to_text()
        return text

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the scene to a text file. Raises OSError if the file cannot be written."""
        self._native.save(os.fspath(path))

    def copy(self) -> Scene:
        """A copy with the same numbers of objects."""
        return Scene._of(self._native.copy())

    @property
    def run(self) -> RunDefaults:
        """How the scene is meant to be run. ``scene.run = rf.RunDefaults(dt=1e-4)`` sets it, and :meth:`save` writes it.

        :class:`Simulation` and :class:`Worlds` take the time step and the integrator from it unless they are given others.
        """
        dt, *others = self._native.run_defaults()
        return RunDefaults(_written(dt), *others)

    @run.setter
    def run(self, value: RunDefaults) -> None:
        if not isinstance(value, RunDefaults):
            raise TypeError(f"run: expected a rockfall.RunDefaults, got {type(value).__name__}")
        dt = None if value.dt is None else time_step("run.dt", value.dt)
        if value.integrator is not None and not isinstance(value.integrator, str):
            raise TypeError(f"run.integrator: expected a str, got {type(value.integrator).__name__}")
        names = ("steps", "every", "substeps")
        numbers = [None if (n := getattr(value, name)) is None else whole(f"run.{name}", n, least=1) for name in names]
        speed = None if value.speed is None else number("run.speed", value.speed, positive=True)
        self._native.set_run_defaults((dt, value.integrator, *numbers, speed))

    def _time_step(self, given: float | None) -> float:
        """The time step that is given, or that of the scene, or 0.02 s."""
        if given is not None:
            return time_step("dt", given)
        own = _written(self._native.time_step())
        return _TIME_STEP if own is None else own

    @property
    def warnings(self) -> list[tuple[int, str]]:
        """Warnings about the text that the scene was read from: line number and text."""
        return list(self._native.warnings())

    def check(self, dt: float | None = None, integrator: IntegratorName = "auto") -> list[str]:
        """Warnings about a time step (in s) or constants that do not suit the scene, about bodies that overlap, and about bodies
        that nothing holds and that fall for ever.

        Without a time step, that of :attr:`run` is checked, or 0.02 s.

        An empty list means that nothing was found. ``rockfall check`` on the command line reports the same. The integrator is
        named as in :class:`Simulation`.
        """
        found: list[str] = self._native.check(self._time_step(dt), integrator)
        return found

    def __copy__(self) -> Scene:
        return self.copy()

    def __deepcopy__(self, memo: Any) -> Scene:
        return self.copy()

    def __reduce__(self) -> Any:
        # The text holds every object and constant, but numbers of objects start again from 0.
        return (_parse, (self.to_text(),))

    def __repr__(self) -> str:
        counts = ", ".join(f"{count} {kind}" for kind, count in self.counts._asdict().items() if count)
        return f"<rockfall.Scene: {counts or 'empty'}>"


def _refuse_comments(text: str, warnings: list[tuple[int, str]], name: str, hint: str = "") -> None:
    """Raises an error for a text that yields nothing, unless it is empty, says so by ``#``, or sets constants to their defaults."""
    taken = "taken for a comment; "
    reasons = {number: text[len(taken) :].split("; begin a comment")[0] for number, text in warnings if text.startswith(taken)}
    lines = [line.strip() for line in text.lstrip("\ufeff").splitlines()]
    words = {number: line.split()[0] for number, line in enumerate(lines, 1) if line and not line.startswith("#")}
    is_understood = not reasons and any(word == "set" or word.startswith("@") for word in words.values())
    if not words or is_understood:
        return
    number = min(reasons or words)
    line = lines[number - 1]
    shown = line if len(line) <= 40 else line[:40] + "..."
    reason = reasons.get(number, "expected for example 'S 1  0 1 0  0 0 0  0 0 0  1 0.5', a sphere")
    raise ValueError(f"{name}:{number}: {shown!r} is not a line of a scene, and the text has no other one: {reason}{hint}")


def _written(number: float | None) -> float | None:
    """The decimal number that was written as f32."""
    return None if number is None else float(str(np.float32(number)))


def _parse(text: str) -> Scene:
    return Scene.parse(text)
