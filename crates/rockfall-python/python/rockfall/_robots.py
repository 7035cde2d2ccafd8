"""Robots of URDF and MJCF files."""

from __future__ import annotations

import os
import warnings

from rockfall import _rockfall
from rockfall._scene import Scene


def load_urdf(path: str | os.PathLike[str]) -> Scene:
    """Read a robot from a URDF file.

    A link becomes a rigid body of its name, and a joint a joint of its name. The scene has the contact law ``rigid``, gravity along
    -z, and no floor. What the file has and the scene does not is in one warning, a :class:`UserWarning`.

    Raises
    ------
    OSError
        If the file cannot be read.
    ValueError
        If it is no URDF file, or has what a scene cannot have; the message names the file, the line and the element.
    """
    return _load(path, "urdf")


def load_mjcf(path: str | os.PathLike[str]) -> Scene:
    """Read a model from an MJCF file of MuJoCo.

    As :func:`load_urdf`. Gravity is that of the file, and so is the floor.

    Raises
    ------
    OSError
        If the file cannot be read.
    ValueError
        If it is no MJCF file, or has what a scene cannot have; the message names the file, the line and the element.
    """
    return _load(path, "mjcf")


def _load(path: str | os.PathLike[str], kind: str) -> Scene:
    native, notes = _rockfall.Scene.load_robot(os.fspath(path), kind)
    if notes:
        warnings.warn("\n".join(notes), UserWarning, stacklevel=3)
    return Scene._of(native)
