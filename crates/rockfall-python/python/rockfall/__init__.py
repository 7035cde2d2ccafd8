"""rockfall: a rigid-body physics engine on the GPU and the CPU, with NumPy arrays.

>>> import numpy as np, rockfall as rf
>>> scene = rf.Scene()
>>> floor = scene.add_box([-5, -1, -5], [5, 0, 5])
>>> balls = scene.add_spheres(np.random.rand(1000, 3) * 4, radius=0.1, mass=1.0)
>>> sim = rf.Simulation(scene, dt=0.01)
>>> report = sim.run(1000)
>>> sim.positions.shape
(1000, 3)
>>> picture = sim.render(size=(960, 540))
"""

from __future__ import annotations

import importlib
import importlib.util
import os
from typing import TYPE_CHECKING, Any

if "XDG_RUNTIME_DIR" not in os.environ:
    # Otherwise a Vulkan layer of Mesa looks for a display and prints an error, which has no effect.
    os.environ.setdefault("NODEVICE_SELECT", "1")

from rockfall import _rockfall
from rockfall import typing as typing
from rockfall._bodies import Capsules
from rockfall._contact_law import ContactLaw, Impact
from rockfall._device import DeviceArray
from rockfall._evolve import Creature, Evolution, evolve
from rockfall._fields import Fields
from rockfall._film import Film, film
from rockfall._flow import Flow, GrainKind, Inflow, Outflow
from rockfall._info import devices, info
from rockfall._joints import JointStates
from rockfall._laws import ForceLaw
from rockfall._materials import Material, Pair
from rockfall._motions import MotionTerm, PlaneFlow, Servo, WallLoad
from rockfall._names import Named, Tag
from rockfall._objects import Counts, Objects
from rockfall._picture import Picture
from rockfall._reports import Backend, Device, Energy, Overlap, Profile, Report, StageTime, State
from rockfall._rigid import BodyStates, MassProperties, RigidBodies, Shape
from rockfall._rockfall import SimulationError
from rockfall._robots import load_mjcf, load_urdf
from rockfall._scene import RunDefaults, Scene
from rockfall._settings import Settings
from rockfall._simulation import SceneWarning, Simulation
from rockfall._static import StaticBody
from rockfall._sweep import SweepError, SweepResult, sweep
from rockfall._tables import to_pandas
from rockfall._trajectory import Frame, Recording, Trajectory
from rockfall._view import view
from rockfall._window import Window
from rockfall._world_mechanisms import WorldBodies, WorldJoints
from rockfall._worlds import Worlds

if TYPE_CHECKING:
    from rockfall import gym as gym

__version__: str = _rockfall.__version__

if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_rockfall.forked)

__all__ = [
    "Backend",
    "BodyStates",
    "Capsules",
    "ContactLaw",
    "Counts",
    "Creature",
    "Device",
    "DeviceArray",
    "Energy",
    "Evolution",
    "Fields",
    "Film",
    "Flow",
    "ForceLaw",
    "Frame",
    "GrainKind",
    "Impact",
    "Inflow",
    "JointStates",
    "MassProperties",
    "Material",
    "MotionTerm",
    "Named",
    "Objects",
    "Outflow",
    "Overlap",
    "Pair",
    "Picture",
    "PlaneFlow",
    "Profile",
    "Recording",
    "Report",
    "RigidBodies",
    "RunDefaults",
    "Scene",
    "SceneWarning",
    "Servo",
    "Settings",
    "Shape",
    "Simulation",
    "SimulationError",
    "StageTime",
    "State",
    "StaticBody",
    "SweepError",
    "SweepResult",
    "Tag",
    "Trajectory",
    "WallLoad",
    "Window",
    "WorldBodies",
    "WorldJoints",
    "Worlds",
    "devices",
    "evolve",
    "film",
    "info",
    "load_mjcf",
    "load_urdf",
    "sweep",
    "to_pandas",
    "view",
]


def __dir__() -> list[str]:
    """What is public."""
    has_gym = importlib.util.find_spec("gymnasium") is not None
    return sorted([*__all__, "typing", *(["gym"] if has_gym else []), *(name for name in globals() if name.startswith("__"))])


def __getattr__(name: str) -> Any:
    """Imports :mod:`rockfall.gym` when it is used, because it needs Gymnasium."""
    if name == "gym":
        return importlib.import_module("rockfall.gym")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
