"""The physical constants."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from rockfall import _rockfall
from rockfall._arrays import floats
from rockfall._attributes import Strict, hint
from rockfall.typing import ContactLawName, PrecisionName

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from rockfall._options import SettingValues


def _to_text(name: str, value: Any, default: str) -> str:
    """Writes a value as the text of the constant. The kind of the default is the kind of the constant."""
    if default in ("on", "off"):
        if not isinstance(value, (bool, np.bool_)):
            raise TypeError(f"{name}: expected True or False, got {value!r}")
        return "on" if value else "off"
    if "," in default:
        return ",".join(str(number) for number in floats(name, value, (3,), 1)[0])
    if default == "auto":
        if not isinstance(value, str):
            what = "a contact law" if name == "contact_law" else "a precision"
            raise TypeError(f"{name}: expected the name of {what}, got {value!r}")
        return value
    if isinstance(value, (bool, str, bytes)):
        raise TypeError(f"{name}: expected a number, got {value!r}")
    if name == "gravity" and np.shape(value) == (3,):
        raise ValueError("gravity: expected a number, got a vector: gravity is the magnitude, gravity_direction the direction")
    return str(floats(name, value, (), 1)[0])


def _from_text(text: str) -> bool | float | str | tuple[float, ...]:
    if text in ("on", "off"):
        return text == "on"
    if "," in text:
        return tuple(float(number) for number in text.split(","))
    try:
        return float(text)
    except ValueError:
        return text


class Settings(Strict):
    """The physical constants of a scene or a simulation, as attributes.

    ``settings.gravity = 9.81`` changes a constant from the next step on. Every attribute has a docstring with its unit:
    ``help(rf.Settings)``. Iterating gives the names, and ``dict(settings.items())`` all values.

    Raises
    ------
    ValueError
        For a value that is not allowed.
    TypeError
        For a value of another kind, for example a text for a number.
    AttributeError
        For a constant that does not exist.
    """

    if not TYPE_CHECKING:
        # Type checkers would refuse to set the attributes below.
        __slots__ = ("_native",)

    if TYPE_CHECKING:
        activation_threshold: float
        restitution: float
        contact_damping: float
        contact_force: float
        friction: float
        coulomb_friction: float
        collision_friction: float
        linear_damping: float
        angular_damping: float
        contact_law: ContactLawName
        gravity: float
        collisions: bool
        continuous_collisions: bool
        gravity_direction: tuple[float, float, float]
        contact_pull: bool
        resting_overlap: float
        mesh_angle: float
        precision: PrecisionName

    def __init__(self, native: Any) -> None:
        self._native = native

    def __iter__(self) -> Iterator[str]:
        return iter(SETTINGS)

    def __len__(self) -> int:
        return len(SETTINGS)

    def __getitem__(self, name: str) -> Any:
        if name not in SETTINGS:
            raise KeyError(name)
        return getattr(self, name)

    def __setitem__(self, name: str, value: Any) -> None:
        if name not in SETTINGS:
            raise KeyError(f"{name}: {hint(name, SETTINGS)}")
        setattr(self, name, value)

    def keys(self) -> tuple[str, ...]:
        """The names of all constants."""
        return SETTINGS

    def items(self) -> list[tuple[str, Any]]:
        """The names and values of all constants."""
        return [(name, getattr(self, name)) for name in SETTINGS]

    def update(self, **values: Unpack[SettingValues]) -> None:
        """Sets several constants by name."""
        for name, value in values.items():
            if name not in SETTINGS:
                raise AttributeError(f"{name}: {hint(name, SETTINGS)}")
            setattr(self, name, value)

    def __reduce__(self) -> Any:
        # The copy belongs to no scene.
        return (_settings, ({name: _rockfall.get_setting(self._native, name) for name in SETTINGS},))

    def __repr__(self) -> str:
        return "Settings(" + ", ".join(f"{name}={value}" for name, value in self.items()) + ")"


def _settings(texts: dict[str, str]) -> Settings:
    native = _rockfall.Scene()
    for name, text in texts.items():
        _rockfall.set_setting(native, name, text)
    return Settings(native)


def _add_property(name: str, default: str, unit: str, doc: str) -> None:
    def get(self: Settings) -> Any:
        return _from_text(_rockfall.get_setting(self._native, name))

    def put(self: Settings, value: Any) -> None:
        _rockfall.set_setting(self._native, name, _to_text(name, value, default))

    text = f"{doc.strip()}\n\nDefault {default}" + (f", in {unit}." if unit else ".")
    setattr(Settings, name, property(get, put, doc=text))


for _name, _default, _unit, _doc in _rockfall.constants():
    _add_property(_name, _default, _unit, _doc)
#: The names of all constants.
SETTINGS: tuple[str, ...] = tuple(row[0] for row in _rockfall.constants())
