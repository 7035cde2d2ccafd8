"""Types of arguments that are names, for annotations: ``backend: rf.typing.BackendName = "cpu"``."""

from __future__ import annotations

from typing import Literal

__all__ = [
    "BackendName",
    "BodyName",
    "BroadPhaseName",
    "CohesionName",
    "ColourName",
    "ContactLawName",
    "FieldName",
    "GoalName",
    "IntegratorName",
    "KernelName",
    "KindName",
    "LookName",
    "PrecisionName",
    "RollingModelName",
    "TaggedName",
    "UpName",
]

BackendName = Literal["auto", "gpu", "cpu"]
IntegratorName = Literal["auto", "rk4", "symplectic-euler", "velocity-verlet"]
BroadPhaseName = Literal["auto", "brute-force", "sort-and-skip", "grid"]
#: Kinds of objects, for :meth:`Objects.remove` and :meth:`Objects.table`.
KindName = Literal["sphere", "rod", "capsule", "spring", "tether", "box", "polygon"]
#: Kinds of objects that can have names, for :meth:`Objects.set_tag`.
TaggedName = Literal["sphere", "rod", "capsule", "spring", "box", "polygon"]
#: What the colours of pictures show.
ColourName = Literal["kind", "speed", "contacts", "overlap", "force", "body", "contact-force", "tension"]
ContactLawName = Literal["auto", "thesis", "linear", "hertz-mindlin", "user", "rigid"]
#: How surfaces of objects are drawn, for :meth:`Objects.set_tag`.
LookName = Literal["plain", "striped", "wood", "stone", "glass"]
PrecisionName = Literal["auto", "single", "double"]
RollingModelName = Literal["a", "c"]
#: Bodies and goals of :func:`evolve`.
BodyName = Literal["lattice", "free"]
GoalName = Literal["distance", "speed", "height", "jump", "climb"]
#: Axis to the top of pictures.
UpName = Literal["auto", "y", "z"]
CohesionName = Literal["dmt", "jkr"]
#: Smoothing functions of :meth:`Simulation.fields`.
KernelName = Literal["gaussian", "heaviside"]
#: States that :meth:`Worlds.record` records.
FieldName = Literal["positions", "velocities", "orientations", "angular_momenta"]
